"""The simulator, with a measurement of the wall time that it takes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.ports.simulation import ExpectedGrasp, GripperResult
from harness.session.timing import Clock
from harness.simulation.mujoco_simulator import MujocoSimulator
from harness.simulation.set_points import SetPoints

SAMPLES_BETWEEN_LOOKS = 128
"""Samples between two calls of `watch`; the results do not depend on it."""


class TimedSimulator(MujocoSimulator):
    """The simulator, which measures the wall time of what moves apart from that of planning.

    Attributes:
        watch: Called about a hundred times a second while the physics advances; None: never. What
            it does must not change the simulator.
    """

    def __init__(self, clock: Clock, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._clock = clock
        self.watch: Callable[[], None] | None = None

    def _step(self, points: SetPoints, controls: FloatArray) -> None:
        if self.watch is None:
            return super()._step(points, controls)
        count = len(points) - 1
        for begin in range(0, count, SAMPLES_BETWEEN_LOOKS):
            end = min(begin + SAMPLES_BETWEEN_LOOKS, count)
            super()._step(points.part(begin, end), controls[begin : end + 1])
            self.watch()
        return None

    def track(self, trajectory: JointTrajectory) -> None:
        with self._clock.part("simulate"):
            super().track(trajectory)

    def command_gripper(
        self,
        position: float,
        max_effort: float,
        *,
        timeout: float,
        expected: ExpectedGrasp | None = None,
    ) -> GripperResult:
        with self._clock.part("simulate"):
            return super().command_gripper(position, max_effort, timeout=timeout, expected=expected)

    def hold(self, duration: float) -> None:
        with self._clock.part("simulate"):
            super().hold(duration)

    def settle(self, max_velocity: float, timeout: float) -> bool:
        with self._clock.part("simulate"):
            return super().settle(max_velocity, timeout)
