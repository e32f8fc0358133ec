"""Computes the fastest motion from 0 to 1 under a jerk limit, by Ruckig."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ruckig

from harness.core.types import FloatArray
from harness.planning.timing.limits import TimingError
from harness.planning.timing.profiles import on_grid


@dataclass(frozen=True, eq=False)
class JerkLimited:
    """From 0 to 1, without velocity and acceleration at both ends, stretched to the time grid.

    Attributes:
        duration: The duration, a whole multiple of `GRID` [s].
    """

    duration: float
    _trajectory: ruckig.Trajectory

    @classmethod
    def fastest(cls, velocity: float, acceleration: float, jerk: float) -> JerkLimited:
        """The fastest profile under limits of the parameter's rate, acceleration and jerk.

        Raises:
            TimingError: Ruckig has no solution.

        References:
            L. Berscheid, T. Kroeger, "Jerk-limited Real-time Trajectory Generation with Arbitrary
            Target States", Robotics: Science and Systems, 2021.
        """
        problem = ruckig.InputParameter(1)
        problem.current_position, problem.target_position = [0.0], [1.0]
        problem.max_velocity, problem.max_acceleration = [velocity], [acceleration]
        problem.max_jerk = [jerk]
        found = ruckig.Trajectory(1)
        answer = ruckig.Ruckig(1).calculate(problem, found)
        if answer not in (ruckig.Result.Working, ruckig.Result.Finished):
            raise TimingError(f"Ruckig finds no motion under the jerk limit: {answer.name}")
        return cls(on_grid(found.duration), found)

    def __call__(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parameter, its rate and its acceleration at times (N,)."""
        share = self._trajectory.duration / self.duration
        inside = np.clip(times * share, 0.0, self._trajectory.duration)
        rows = np.array([self._trajectory.at_time(time) for time in inside]).reshape(-1, 3)
        return rows[:, 0], rows[:, 1] * share, rows[:, 2] * share**2
