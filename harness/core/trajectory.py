"""Joint trajectories."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray


def path_length(waypoints: FloatArray) -> float:
    """Sum of the L2 norms of the segments between waypoints, shape (N, dof) [rad]."""
    return float(np.linalg.norm(np.diff(waypoints, axis=0), axis=1).sum())


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Set points of a group's joints over time, starting at time zero.

    Attributes:
        joint_names: The planning group's joints, in order.
        times: Strictly rising [s], shape (N,), times[0] == 0.
        positions: The joint positions, shape (N, dof), rad or m.
        velocities: The joint velocities, shape (N, dof).
        accelerations: The joint accelerations, shape (N, dof).
    """

    joint_names: tuple[str, ...]
    times: FloatArray
    positions: FloatArray
    velocities: FloatArray
    accelerations: FloatArray

    @property
    def duration(self) -> float:
        """Time of the last set point [s]."""
        return float(self.times[-1])

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, velocities and accelerations at times, shape (N, dof) each.

        They are those of the cubic Hermite splines through its positions and velocities, which
        start before time zero and end after the last set point at rest.
        """
        if len(self.times) < 2:
            positions = np.repeat(self.positions, len(times), axis=0)
            return positions, np.zeros_like(positions), np.zeros_like(positions)
        knots = self.times
        times = np.clip(times, knots[0], knots[-1])
        segment = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(knots) - 2)
        length = (knots[segment + 1] - knots[segment])[:, None]
        s = (times[:, None] - knots[segment, None]) / length
        start, end = self.positions[segment], self.positions[segment + 1]
        out = length * self.velocities[segment]
        into = length * self.velocities[segment + 1]
        square = 3.0 * (end - start) - 2.0 * out - into
        cube = out + into - 2.0 * (end - start)
        positions = start + s * (out + s * (square + s * cube))
        velocities = (out + s * (2.0 * square + 3.0 * s * cube)) / length
        accelerations = (2.0 * square + 6.0 * s * cube) / length**2
        return positions, velocities, accelerations
