"""How joints answer a set point that jumps: as a position interface does, not at once."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.plugins.ros.control.controller import Rows

TIME_CONSTANT = 0.1
"""Time in which most of a step is done [s]: that of Gazebo's position interface, which moves by a
tenth of the error in each of 100 updates a second. Here it is shared by two equal lags, so that the
velocity does not jump either."""

SMALLEST_JUMP = 1e-6  # what is rounding, and no jump [rad or m]
DECAYED = 25.0  # time constants of a lag after which nothing is left


class StepResponse:
    """What the set points still lack of the commanded ones, for each actuated joint."""

    def __init__(self, velocity_limits: FloatArray) -> None:
        """Lack nothing.

        Args:
            velocity_limits: The limits of the actuated joints [rad/s or m/s]; a large step takes so
                long that they are kept.
        """
        self._limits = velocity_limits
        self._lack = np.zeros((2, len(velocity_limits)))
        self._lag = np.full(len(velocity_limits), TIME_CONSTANT / 2)
        self._begin = self._end = -np.inf

    def add(self, now: float, columns: IntArray, jump: FloatArray) -> None:
        """The commanded positions of some joints jump.

        Args:
            now: The simulated time of the jump [s].
            columns: The joints' places among the actuated ones.
            jump: New positions less those before, shape (k,).
        """
        if np.abs(jump).max(initial=0.0) <= SMALLEST_JUMP:
            return
        self._lack = self._at(np.array([now]))[:2, 0]
        self._lack[0, columns] -= jump
        # A step of two equal lags is fastest after one lag: at its size over e times the lag.
        slowest = np.abs(self._lack[0]) / (np.e * self._limits)
        self._lag = np.maximum(TIME_CONSTANT / 2, slowest)
        self._begin, self._end = now, now + DECAYED * float(self._lag.max())

    def stop(self, columns: IntArray) -> None:
        """Some joints hold where they are."""
        self._lack[:, columns] = 0.0

    def applied(self, times: FloatArray, rows: Rows) -> Rows:
        """The set points of the joints for the commanded ones, shape (3, N, n)."""
        return rows if times[0] > self._end else rows + self._at(times)

    def _at(self, times: FloatArray) -> Rows:
        """What is lacking at some times [s]: (p + (v + p / lag) t) exp(-t / lag)."""
        if times[0] > self._end:
            return np.zeros((3, len(times), len(self._limits)))
        since, lag = (times - self._begin)[:, None], self._lag
        first = self._lack[0]
        second = self._lack[1] + first / lag
        decay = np.exp(-since / lag)
        positions = (first + second * since) * decay
        velocities = second * decay - positions / lag
        accelerations = -second * decay / lag - velocities / lag
        return np.array([positions, velocities, accelerations])
