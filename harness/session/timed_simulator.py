"""The simulator, with a measurement of the wall time that it takes."""

from __future__ import annotations

from typing import Any

from harness.core.trajectory import JointTrajectory
from harness.ports.simulation import GripperResult
from harness.session.timing import Clock
from harness.simulation.mujoco_simulator import MujocoSimulator


class TimedSimulator(MujocoSimulator):
    """The simulator, which measures the wall time of what moves apart from that of planning."""

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
