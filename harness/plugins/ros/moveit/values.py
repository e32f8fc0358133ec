"""Poses, states, trajectories and error codes between messages of MoveIt and the program."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.language.base import LARGEST_NUMBER
from harness.plugins.ros.bag.messages import message, trajectory_message
from harness.plugins.ros.interfaces import header
from harness.robot.description import RobotDescription

SUCCESS = 1
SMALLEST_NORM = 1e-9  # of a quaternion; a smaller one is that of an empty message
NUMBERS: Mapping[str, int] = {
    "FAILURE": 99999,
    "PLANNING_FAILED": -1,
    "INVALID_MOTION_PLAN": -2,
    "MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE": -3,
    "CONTROL_FAILED": -4,
    "UNABLE_TO_AQUIRE_SENSOR_DATA": -5,
    "TIMED_OUT": -6,
    "PREEMPTED": -7,
    "START_STATE_IN_COLLISION": -10,
    "START_STATE_VIOLATES_PATH_CONSTRAINTS": -11,
    "GOAL_IN_COLLISION": -12,
    "GOAL_VIOLATES_PATH_CONSTRAINTS": -13,
    "GOAL_CONSTRAINTS_VIOLATED": -14,
    "INVALID_GROUP_NAME": -15,
    "INVALID_GOAL_CONSTRAINTS": -16,
    "INVALID_ROBOT_STATE": -17,
    "INVALID_LINK_NAME": -18,
    "INVALID_OBJECT_NAME": -19,
    "FRAME_TRANSFORM_FAILURE": -21,
    "COLLISION_CHECKING_UNAVAILABLE": -22,
    "ROBOT_STATE_STALE": -23,
    "SENSOR_INFO_STALE": -24,
    "COMMUNICATION_FAILURE": -25,
    "START_STATE_INVALID": -26,
    "GOAL_STATE_INVALID": -27,
    "UNRECOGNIZED_GOAL_TYPE": -28,
    "CRASH": -29,
    "ABORT": -30,
    "NO_IK_SOLUTION": -31,
}
"""Numbers of moveit_msgs/MoveItErrorCodes."""


def error_code(failure: StepFailed | None) -> Any:
    """The MoveItErrorCodes of a failure, with its sentence; of success without one."""
    kind = "moveit_msgs/msg/MoveItErrorCodes"
    if failure is None:
        return message(kind, val=SUCCESS)
    return message(kind, val=NUMBERS[failure.code], message=failure.message, source="armharness")


def pose_of(pose: Any) -> SE3:
    """The pose of a geometry_msgs/Pose; one without a rotation is not turned.

    Raises:
        StepFailed: A number of it is not finite, or beyond `LARGEST_NUMBER`.
    """
    position, turn = pose.position, pose.orientation
    quaternion = np.array([turn.w, turn.x, turn.y, turn.z], dtype=float)
    xyz = np.array([position.x, position.y, position.z], dtype=float)
    if not (np.abs([*quaternion, *xyz]) <= LARGEST_NUMBER).all():  # which NaN is not
        reason = f"a pose has numbers that are not finite, or beyond {LARGEST_NUMBER:g}"
        raise StepFailed("INVALID_GOAL_CONSTRAINTS", reason)
    if math.hypot(*quaternion) < SMALLEST_NORM:
        quaternion = np.array([1.0, 0.0, 0.0, 0.0])
    return SE3.from_xyz_quat(xyz, quaternion)


def frame_of(cell: Cell, frame_id: str) -> SE3:
    """T_world_frame of a header's frame; an empty one is the world.

    Raises:
        StepFailed: FRAME_TRANSFORM_FAILURE, where there is no such frame now.
    """
    return cell.frame(frame_id.lstrip("/") or "world")


def arm_of(cell: Cell, group: str) -> RobotDescription:
    """The robot, with the arm selected that has a group's joints; unchanged where none has."""
    robot = cell.description
    return robot.of_arm.get(robot.arm_of_group(group), robot)


def link_of(cell: Cell, name: str, group: str = "") -> str:
    """A link by its name; an empty one is the TCP's of the arm that has a group's joints.

    Raises:
        StepFailed: INVALID_LINK_NAME.
    """
    robot = arm_of(cell, group)
    if not name and robot.needs_arm:
        reason = (
            f"a request names no link, and the robot has several arms: {', '.join(robot.of_arm)}"
        )
        raise StepFailed("INVALID_LINK_NAME", reason)
    link = str(name) or robot.tcp_link
    if link not in cell.description.link_names:
        raise StepFailed("INVALID_LINK_NAME", f"the robot has no link '{link[:80]}'")
    return link


def positions_of(cell: Cell, state: Any) -> FloatArray:
    """The joint positions of a RobotState in description order; others are as they are now.

    Raises:
        StepFailed: INVALID_ROBOT_STATE, for a joint that the robot lacks or a bad number.
    """
    positions, index = cell.planning_start(), cell.description.joint_index
    joints = state.joint_state
    if len(joints.name) > len(joints.position):
        raise StepFailed("INVALID_ROBOT_STATE", "the state has more names than positions")
    for name, value in zip(joints.name, joints.position, strict=False):
        if str(name) not in index:
            raise StepFailed("INVALID_ROBOT_STATE", f"the robot has no joint '{str(name)[:80]}'")
        if not np.isfinite(value):
            raise StepFailed("INVALID_ROBOT_STATE", f"the position of '{name}' is not finite")
        positions[index[str(name)]] = value
    return cell.description.with_mimics(positions)


def state_message(cell: Cell, positions: FloatArray, **fields: Any) -> Any:
    """A RobotState of joint positions in description order."""
    joints = message(
        "sensor_msgs/msg/JointState",
        header=header(cell.simulator.time),
        name=list(cell.description.joint_names),
        position=positions,
    )
    return message("moveit_msgs/msg/RobotState", joint_state=joints, **fields)


def robot_trajectory(plan: JointTrajectory | None) -> Any:
    """A RobotTrajectory; of None an empty one."""
    kind = "moveit_msgs/msg/RobotTrajectory"
    return message(kind, joint_trajectory=trajectory_message(plan)) if plan else message(kind)
