"""Splines through the points of a trajectory, as joint_trajectory_controller interpolates."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PPoly

from harness.core.types import FloatArray

Rows = FloatArray
"""Positions, velocities and accelerations, shape (3, N, dof)."""


class Spline:
    """Segments between knots: linear, cubic or quintic, by what the points give.

    Attributes:
        end: The time of the last knot [s].
    """

    def __init__(
        self,
        times: FloatArray,
        positions: FloatArray,
        velocities: FloatArray | None = None,
        accelerations: FloatArray | None = None,
    ) -> None:
        """Fit the segments.

        Args:
            times: Strictly rising [s], shape (K,).
            positions: The positions at the knots, shape (K, dof).
            velocities: The velocities, shape (K, dof); None for straight segments.
            accelerations: The accelerations, shape (K, dof); None where segments are not quintic.
        """
        self.begin, self.end, self._target = float(times[0]), float(times[-1]), positions[-1]
        if len(times) == 1:  # a motion of no length, ahead of which and after which it rests
            times, positions = np.array([times[0], times[0] + 1.0]), positions[[0, 0]]
            velocities = accelerations = None
        span, way = np.diff(times)[:, None], np.diff(positions, axis=0)
        if velocities is None:
            factors = [positions[:-1], way / span]
        elif accelerations is None:
            v0, v1 = velocities[:-1] * span, velocities[1:] * span
            cubic = [(3 * way - 2 * v0 - v1) / span**2, (v0 + v1 - 2 * way) / span**3]
            factors = [positions[:-1], velocities[:-1], *cubic]
        else:
            v0, v1 = velocities[:-1] * span, velocities[1:] * span
            a0, a1 = accelerations[:-1] * span**2, accelerations[1:] * span**2
            quintic = [
                (10 * way - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1) / span**3,
                (-15 * way + 8 * v0 + 7 * v1 + 1.5 * a0 - a1) / span**4,
                (6 * way - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1) / span**5,
            ]
            factors = [positions[:-1], velocities[:-1], accelerations[:-1] / 2, *quintic]
        self._polynomial = PPoly(np.array(factors[::-1]), times)

    def at(self, times: FloatArray) -> Rows:
        """The motion at some times [s], shape (N,); at rest before the first knot and after."""
        inside, over = np.maximum(times, self.begin), times >= self.end
        rows = np.array([self._polynomial(inside, nu=order) for order in range(3)])
        rows[0, over] = self._target
        rows[1:, over | (times < self.begin)] = 0.0
        return rows
