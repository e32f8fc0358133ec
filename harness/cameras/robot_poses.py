"""Link poses from recorded joint positions."""

from __future__ import annotations

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.robot.description import Joint, RobotDescription


def rendered_link_poses(
    description: RobotDescription, joint_positions: FloatArray
) -> dict[str, SE3]:
    """T_world_link of every link.

    Args:
        description: The description of the robot.
        joint_positions: Joint positions in description order, shape (n,).
    """
    poses = {"world": SE3.identity()}
    for joint in description.joints:
        position = 0.0
        if joint.is_movable:
            position = float(joint_positions[description.joint_index[joint.name]])
        poses[joint.child] = poses[joint.parent] @ joint.pose @ _motion(joint, position)
    return poses


def _motion(joint: Joint, position: float) -> SE3:
    if joint.kind == "fixed":
        return SE3.identity()
    if joint.kind == "prismatic":
        return SE3(np.eye(3), position * joint.axis)
    half = 0.5 * position
    return SE3.from_xyz_quat(np.zeros(3), [np.cos(half), *(np.sin(half) * joint.axis)])
