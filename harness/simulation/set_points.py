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
    knots = trajectory.times
    times = np.minimum(np.arange(count + 1) * timestep, knots[-1])
    segment = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(knots) - 2)
    length = (knots[segment + 1] - knots[segment])[:, None]
    s = (times[:, None] - knots[segment, None]) / length
    start, end = trajectory.positions[segment], trajectory.positions[segment + 1]
    out = length * trajectory.velocities[segment]
    into = length * trajectory.velocities[segment + 1]
    square = 3.0 * (end - start) - 2.0 * out - into
    cube = out + into - 2.0 * (end - start)
    positions = start + s * (out + s * (square + s * cube))
    velocities = (out + s * (2.0 * square + 3.0 * s * cube)) / length
    accelerations = (2.0 * square + 6.0 * s * cube) / length**2
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
