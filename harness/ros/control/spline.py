"""Splines through the points of a trajectory, as joint_trajectory_controller interpolates."""

from __future__ import annotations

import numpy as np

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
        self.end, self._target = float(times[-1]), positions[-1]
        if len(times) == 1:  # a motion of no length, ahead of which and after which it rests
            times, positions = np.array([times[0], times[0] + 1.0]), positions[[0, 0]]
            velocities = accelerations = None
        span, way = np.diff(times)[:, None], np.diff(positions, axis=0)
        known = [positions[:-1]]
        if velocities is None:
            rest = [way / span]
        elif accelerations is None:
            v0, v1 = velocities[:-1] * span, velocities[1:] * span
            known.append(velocities[:-1])
            rest = [(3 * way - 2 * v0 - v1) / span**2, (v0 + v1 - 2 * way) / span**3]
        else:
            v0, v1 = velocities[:-1] * span, velocities[1:] * span
            a0, a1 = accelerations[:-1] * span**2, accelerations[1:] * span**2
            known += [velocities[:-1], accelerations[:-1] / 2]
            rest = [
                (10 * way - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1) / span**3,
                (-15 * way + 8 * v0 + 7 * v1 + 1.5 * a0 - a1) / span**4,
                (6 * way - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1) / span**5,
            ]
        self._knots, self._factors = times[:-1], np.array([*known, *rest])

    def at(self, times: FloatArray) -> Rows:
        """The motion at some times; at rest at the nearest knot before the first and from the last.

        Args:
            times: Rising [s], shape (N,).
        """
        over = times >= self.end
        elapsed = np.maximum(times, self._knots[0])
        segment = np.searchsorted(self._knots, elapsed, side="right") - 1
        elapsed = (elapsed - self._knots[segment])[:, None]
        rows = np.zeros((3, len(times), len(self._target)))
        position, velocity, acceleration = rows
        for factor in self._factors[::-1, segment]:  # Horner's scheme and its derivatives
            acceleration *= elapsed
            acceleration += 2.0 * velocity
            velocity *= elapsed
            velocity += position
            position *= elapsed
            position += factor
        position[over] = self._target
        rows[1:, over | (times < self._knots[0])] = 0.0
        return rows
