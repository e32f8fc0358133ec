"""Splines through the points of a trajectory, as joint_trajectory_controller interpolates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray

Rows = tuple[FloatArray, FloatArray, FloatArray]
"""Positions, velocities and accelerations, shape (N, dof) each."""


@dataclass(frozen=True, eq=False)
class Spline:
    """Segments between knots: linear, cubic or quintic, by what the points give.

    Attributes:
        times: Strictly rising [s], shape (K,).
        positions: The positions at the knots, shape (K, dof).
        velocities: The velocities, shape (K, dof); None for straight segments.
        accelerations: The accelerations, shape (K, dof); None where segments are not quintic.
    """

    times: FloatArray
    positions: FloatArray
    velocities: FloatArray | None = None
    accelerations: FloatArray | None = None

    @property
    def end(self) -> float:
        """The time of the last knot [s]."""
        return float(self.times[-1])

    def at(self, times: FloatArray) -> Rows:
        """The motion at some times; at rest at the nearest knot before the first and from the last.

        Args:
            times: Rising [s], shape (N,).
        """
        clipped = np.clip(times, self.times[0], self.times[-1])
        if len(self.times) == 1:
            rest = np.zeros((len(times), self.positions.shape[1]))
            return np.repeat(self.positions, len(times), axis=0), rest, rest.copy()
        knot = np.clip(
            np.searchsorted(self.times, clipped, side="right") - 1, 0, len(self.times) - 2
        )
        span = (self.times[knot + 1] - self.times[knot])[:, None]
        coefficients = self._coefficients(knot, span)
        elapsed = (clipped - self.times[knot])[:, None]
        position, velocity, acceleration = (np.zeros_like(coefficients[0]) for _ in range(3))
        for factor in reversed(coefficients):  # Horner's scheme and its derivatives
            acceleration = acceleration * elapsed + 2.0 * velocity
            velocity = velocity * elapsed + position
            position = position * elapsed + factor
        still = (times < self.times[0]) | (times >= self.times[-1])
        velocity[still] = 0.0
        acceleration[still] = 0.0
        position[times >= self.times[-1]] = self.positions[-1]
        return position, velocity, acceleration

    def _coefficients(self, knot: np.ndarray, h: FloatArray) -> list[FloatArray]:
        """Coefficients of each row's segment, constant first."""
        p0, p1 = self.positions[knot], self.positions[knot + 1]
        if self.velocities is None:
            return [p0, (p1 - p0) / h]
        v0, v1 = self.velocities[knot], self.velocities[knot + 1]
        if self.accelerations is None:
            return [
                p0,
                v0,
                (3.0 * (p1 - p0) / h - 2.0 * v0 - v1) / h,
                (2.0 * (p0 - p1) / h + v0 + v1) / h**2,
            ]
        a0, a1 = self.accelerations[knot], self.accelerations[knot + 1]
        way = p1 - p0
        return [
            p0,
            v0,
            0.5 * a0,
            (20 * way - (8 * v1 + 12 * v0) * h - (3 * a0 - a1) * h**2) / (2 * h**3),
            (-30 * way + (14 * v1 + 16 * v0) * h + (3 * a0 - 2 * a1) * h**2) / (2 * h**4),
            (12 * way - 6 * (v1 + v0) * h - (a0 - a1) * h**2) / (2 * h**5),
        ]
