"""Set points of a trajectory, and of a gripper's ramp, at every physics step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class SetPoints:
    """Commanded motion at every physics step, from the start to the goal, both included.

    Attributes:
        positions: Joint positions, shape (N, dof).
        velocities: Joint velocities, shape (N, dof); zero in the last row if it ends at rest.
        accelerations: Joint accelerations, shape (N, dof).
    """

    positions: FloatArray
    velocities: FloatArray
    accelerations: FloatArray

    def __len__(self) -> int:
        return len(self.positions)

    def part(self, begin: int, end: int) -> SetPoints:
        """The set points from one row to another, both included."""
        return SetPoints(*(rows[begin : end + 1] for rows in vars(self).values()))


def sample_trajectory(trajectory: JointTrajectory, timestep: float) -> SetPoints:
    """Sample the cubic Hermite splines through positions and velocities of a trajectory."""
    count = max(1, int(np.ceil(trajectory.duration / timestep - 1e-9)))
    if len(trajectory.times) < 2:
        still = np.zeros_like(trajectory.positions)
        return SetPoints(trajectory.positions, still, still)
    positions, velocities, accelerations = trajectory.at(np.arange(count + 1.0) * timestep)
    accelerations[-1] = 0.0
    return SetPoints(positions, velocities, accelerations)


def ramp(
    start: float, goal: float, velocity: float, acceleration: float, timestep: float
) -> SetPoints:
    """A motion of one joint with a trapezoid of velocity, at rest at both ends; (N, 1) each."""
    distance = abs(goal - start)
    peak = min(velocity, float(np.sqrt(distance * acceleration)))
    if peak == 0.0:
        still = np.zeros((1, 1))
        return SetPoints(np.array([[goal]]), still, still)
    rise = peak / acceleration
    total = distance / peak + rise
    times = np.arange(int(np.ceil(total / timestep)) + 1)[:, None] * timestep
    up = np.minimum(times, rise)
    down = np.clip(times - (total - rise), 0.0, rise)
    velocities = acceleration * (up - down)
    level = np.clip(times - rise, 0.0, total - rise)
    travelled = 0.5 * acceleration * up**2 + peak * level - 0.5 * acceleration * down**2
    direction = np.sign(goal - start)
    accelerations = acceleration * ((times < rise).astype(float) - (down > 0) * (down < rise))
    return SetPoints(
        start + direction * travelled, direction * velocities, direction * accelerations
    )
