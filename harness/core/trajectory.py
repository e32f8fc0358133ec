"""Joint paths without time, and joint trajectories with time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray


def path_length(waypoints: FloatArray) -> float:
    """Sum of the L2 norms of the segments between waypoints, shape (N, dof) [rad]."""
    return float(np.linalg.norm(np.diff(waypoints, axis=0), axis=1).sum())


@dataclass(frozen=True, eq=False)
class JointPath:
    """Waypoints joined by straight joint-space segments, without time.

    Attributes:
        joint_names: The planning group's joints, in order.
        waypoints: The joint positions, shape (N, dof), rad or m.
    """

    joint_names: tuple[str, ...]
    waypoints: FloatArray

    def length(self) -> float:
        """Sum of the segments' joint-space L2 norms [rad]."""
        return path_length(self.waypoints)


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
