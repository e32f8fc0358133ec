"""What a request requires of a whole trajectory: path constraints, and the speed of a link."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.plugins.ros.moveit.goals import path_constraints_of
from harness.plugins.ros.moveit.kept import kept
from harness.plugins.ros.moveit.values import link_of


def check_constraints(
    cell: Cell, request: Any, trajectory: JointTrajectory, start: FloatArray
) -> None:
    """Check the path constraints of a motion that has only one path.

    Raises:
        StepFailed: INVALID_MOTION_PLAN, with the constraint that is broken.
    """
    constraints = path_constraints_of(cell, request.path_constraints)
    for time, row in zip(trajectory.times, _whole_rows(cell, trajectory, start), strict=True):
        for each in kept(cell, constraints, row):
            if not each.holds:
                reason = f"the motion breaks the constraint of the {each.what} at {time:.2f} s"
                raise StepFailed("INVALID_MOTION_PLAN", f"{reason} by {each.excess:.3g}")


def _whole_rows(cell: Cell, trajectory: JointTrajectory, start: FloatArray) -> list[FloatArray]:
    """The joint positions of a trajectory in description order, the other joints at a start."""
    index = [cell.description.joint_index[name] for name in trajectory.joint_names]
    rows = np.tile(start, (len(trajectory.times), 1))
    rows[:, index] = trajectory.positions
    return [cell.description.with_mimics(row) for row in rows]


def slowed(
    cell: Cell, request: Any, trajectory: JointTrajectory, start: FloatArray
) -> JointTrajectory:
    """The trajectory, slower where a link would exceed the request's `max_cartesian_speed`.

    Raises:
        StepFailed: INVALID_LINK_NAME.
    """
    limit, name = float(request.max_cartesian_speed), str(request.cartesian_speed_limited_link)
    if not (0 < limit < np.inf and name):
        return trajectory
    rows = np.array(_whole_rows(cell, trajectory, start))
    places = cell.kinematics.link_poses(rows, [link_of(cell, name)])[:, 0, :3]
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    factor = max(1.0, float((lengths / np.diff(trajectory.times)).max(initial=0.0)) / limit)
    return replace(
        trajectory,
        times=trajectory.times * factor,
        velocities=trajectory.velocities / factor,
        accelerations=trajectory.accelerations / factor**2,
    )
