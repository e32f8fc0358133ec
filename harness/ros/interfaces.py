"""Message types of the bridge: those of rosbags, control_msgs, and what actions are made of."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from rosbags.typesys import get_types_from_msg

from harness.reporting.rosbag.messages import TYPESTORE, message, time_message

FOLLOW = "control_msgs/action/FollowJointTrajectory"
GRIPPER = "control_msgs/action/GripperCommand"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
CANCEL = "action_msgs/action/CancelGoal"
"""The service action_msgs/srv/CancelGoal; rosbags takes no messages of the folder `srv`."""

COMMAND = "control_msgs/msg/GripperCommand"
UUID = "unique_identifier_msgs/msg/UUID"
POINT = "trajectory_msgs/msg/JointTrajectoryPoint"
_MULTI_POINT = "trajectory_msgs/msg/MultiDOFJointTrajectoryPoint"
_RESULT = "float64 position\nfloat64 effort\nbool stalled\nbool reached_goal"

ACTIONS = {
    FOLLOW: (
        f"{TRAJECTORY} trajectory\n"
        "trajectory_msgs/msg/MultiDOFJointTrajectory multi_dof_trajectory\n"
        "control_msgs/msg/JointTolerance[] path_tolerance\n"
        "control_msgs/msg/JointComponentTolerance[] component_path_tolerance\n"
        "control_msgs/msg/JointTolerance[] goal_tolerance\n"
        "control_msgs/msg/JointComponentTolerance[] component_goal_tolerance\n"
        "builtin_interfaces/msg/Duration goal_time_tolerance",
        "int32 error_code\nstring error_string",
        "std_msgs/msg/Header header\nstring[] joint_names\n"
        f"{POINT} desired\n{POINT} actual\n{POINT} error\n"
        "string[] multi_dof_joint_names\n"
        f"{_MULTI_POINT} multi_dof_desired\n{_MULTI_POINT} multi_dof_actual\n"
        f"{_MULTI_POINT} multi_dof_error",
    ),
    GRIPPER: (f"{COMMAND} command", _RESULT, _RESULT),
}
"""Goal, result and feedback of each action (control_msgs, BSD-3-Clause, field lists)."""

MESSAGES = {
    COMMAND: "float64 position\nfloat64 max_effort",
    "control_msgs/msg/JointTolerance": (
        "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration"
    ),
    "control_msgs/msg/JointComponentTolerance": (
        "string joint_name\nuint16 component\nfloat64 position\nfloat64 velocity\n"
        "float64 acceleration"
    ),
    f"{CANCEL}_Request": "action_msgs/msg/GoalInfo goal_info",
    f"{CANCEL}_Response": ("int8 return_code\naction_msgs/msg/GoalInfo[] goals_canceling"),
}


def _register() -> None:
    """Let rosbags know the types."""
    definitions = dict(MESSAGES)
    for action, parts in ACTIONS.items():
        goal, result, feedback = (f"{action}_{part}" for part in ("Goal", "Result", "Feedback"))
        definitions |= zip((goal, result, feedback), parts, strict=True)
        definitions |= {
            f"{action}_SendGoal_Request": f"{UUID} goal_id\n{goal} goal",
            f"{action}_SendGoal_Response": "bool accepted\nbuiltin_interfaces/msg/Time stamp",
            f"{action}_GetResult_Request": f"{UUID} goal_id",
            f"{action}_GetResult_Response": f"int8 status\n{result} result",
            f"{action}_FeedbackMessage": f"{UUID} goal_id\n{feedback} feedback",
        }
    for name, definition in definitions.items():
        TYPESTORE.register(get_types_from_msg(definition, name))


_register()


def encoded(content: Any, kind: str) -> bytes:
    """A message as it is sent."""
    return bytes(TYPESTORE.serialize_cdr(content, kind))


def decoded(payload: bytes, kind: str) -> Any:
    """The message of a serialised one; None where the bytes of another program are no such one.

    Bytes after the message do not count: rclpy's serialisation leaves some for each list element.
    """
    known = TYPESTORE.get_msgdef(kind)
    readers = {b"\0\0": known.deserialize_cdr_be, b"\0\1": known.deserialize_cdr_le}
    with suppress(Exception):  # no kind of error is certain
        return readers[payload[:2]](payload[4:], 0, known.cls, TYPESTORE)[0]
    return None


def prepare(kind: str) -> None:
    """Let rosbags write the code of a type now, which takes some milliseconds."""
    TYPESTORE.deserialize_cdr(TYPESTORE.serialize_cdr(message(kind), kind), kind)


def stamp(seconds: float, kind: str = "Time") -> Any:
    """A simulated time as a Time, or a span as a Duration.

    The clock of the bridge begins at 0, as that of Gazebo.
    """
    return time_message(round(seconds * 1e9), kind)


def header(seconds: float, frame_id: str = "") -> Any:
    """A simulated time, and the frame that the content is in."""
    return message("std_msgs/msg/Header", stamp=stamp(seconds), frame_id=frame_id)


def seconds(moment: Any) -> float:
    """A stamp or a duration in seconds."""
    return moment.sec + moment.nanosec * 1e-9
