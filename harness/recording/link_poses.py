"""Where the robot's links stood, from recorded joint positions."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from harness.core.pose_arrays import IDENTITY, compose
from harness.core.types import FloatArray
from harness.recording.run import LinkPlacement, RobotRecord


def link_poses(
    robot: RobotRecord, joint_positions: FloatArray, links: Collection[str] | None = None
) -> dict[str, FloatArray]:
    """T_world_link at every sample, shape (N, 7) each; (1, 7) of links that cannot move.

    Args:
        robot: The robot.
        joint_positions: Columns in the order of `robot.joints`, shape (N, n).
        links: Which to return; all when None.
    """
    columns = {joint.name: column for column, joint in enumerate(robot.joints)}
    poses: dict[str, FloatArray] = {}
    for placement in robot.placements:
        parent = poses.setdefault(placement.parent, IDENTITY[None])
        pose = compose(parent, np.array([placement.pose]))
        if placement.joint:
            pose = compose(pose, _motion(placement, joint_positions[:, columns[placement.joint]]))
        poses[placement.link] = pose
    return poses if links is None else {name: poses[name] for name in links if name in poses}


def _motion(placement: LinkPlacement, positions: FloatArray) -> FloatArray:
    motion = np.tile(IDENTITY, (len(positions), 1))
    if placement.slides:
        motion[:, :3] = positions[:, None] * np.array(placement.axis)
    else:
        motion[:, 3] = np.cos(0.5 * positions)
        motion[:, 4:] = np.sin(0.5 * positions)[:, None] * np.array(placement.axis)
    return motion
