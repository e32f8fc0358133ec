"""Wall time of the parts of a case; told, never judged."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from harness.core.trajectory import JointTrajectory
from harness.ports import GripperResult
from harness.simulation.mujoco_simulator import MujocoSimulator


class Clock:
    """Wall seconds by part."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Add the time spent inside to a part."""
        begin = time.perf_counter()
        try:
            yield
        finally:
            spent = time.perf_counter() - begin
            self.seconds[name] = self.seconds.get(name, 0.0) + spent


class TimedSimulator(MujocoSimulator):
    """The simulator, with the wall time of what moves told apart from planning."""

    def __init__(self, clock: Clock, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._clock = clock

    def track(self, trajectory: JointTrajectory) -> None:
        with self._clock.part("simulate"):
            super().track(trajectory)

    def command_gripper(
        self, position: float, max_effort: float, *, timeout: float
    ) -> GripperResult:
        with self._clock.part("simulate"):
            return super().command_gripper(position, max_effort, timeout=timeout)

    def hold(self, duration: float) -> None:
        with self._clock.part("simulate"):
            super().hold(duration)

    def settle(self, max_velocity: float, timeout: float) -> bool:
        with self._clock.part("simulate"):
            return super().settle(max_velocity, timeout)
