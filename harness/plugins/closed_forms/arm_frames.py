"""Joints and fixed frames of the arm of an inverse kinematics request, for closed forms."""

from __future__ import annotations

from typing import cast

import numpy as np

from harness.core.spatial import SE3
from harness.planning.model.robot_model import GroupSpace
from harness.ports.kinematics import IkRequest
from harness.robot.mechanism import Joint


def arm_joints(request: IkRequest) -> tuple[Joint, ...]:
    """The joints that move, from base to tip."""
    by_name = request.description.joint_by_name
    return tuple(by_name[name] for name in request.space.joint_names)


def fixed_offset(request: IkRequest) -> SE3:
    """T_child_link from the last joint's child link to the goal's link, which is fixed to it."""
    robot = cast("GroupSpace", request.space).robot
    child = arm_joints(request)[-1].child
    return robot.placement(child).inverse() @ robot.placement(request.goal.link)


def base_pose(request: IkRequest) -> SE3:
    """T_world_parent of the first joint's parent link, which is static."""
    robot = cast("GroupSpace", request.space).robot
    zero = np.zeros(len(request.description.joint_names))
    return robot.link_pose(zero, arm_joints(request)[0].parent)
