"""Joint trajectories."""

from __future__ import annotations

from collections.abc import Sequence
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


def together(
    motions: Sequence[tuple[JointTrajectory, float]], names: tuple[str, ...], rest: FloatArray
) -> JointTrajectory:
    """Motions of different joints as one.

    Args:
        motions: Each motion, and the time at which it begins [s].
        names: The joints of the whole.
        rest: Positions of the joints that no motion moves, shape (dof,).
    """
    stamps = [np.round(motion.times + delay, 9) for motion, delay in motions]
    times = np.unique(np.concatenate([[0.0], *stamps]))
    positions = np.tile(rest, (len(times), 1))
    velocities, accelerations = np.zeros_like(positions), np.zeros_like(positions)
    for motion, delay in motions:
        columns = [names.index(name) for name in motion.joint_names]
        rows = motion.at(times - delay)
        moves = ((times > delay) & (times < delay + motion.duration))[:, None]
        positions[:, columns] = rows[0]
        velocities[:, columns] = np.where(moves, rows[1], 0.0)
        accelerations[:, columns] = np.where(moves, rows[2], 0.0)
    return JointTrajectory(names, times, positions, velocities, accelerations)
