"""Message types of the bridge: those of rosbags, control_msgs, and what actions are made of."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from harness.plugins.ros.bag.messages import TYPESTORE, message, time_message

DEFINITIONS = Path(__file__).with_name("definitions")
"""Field lists of control_msgs (BSD-3-Clause), action_msgs (Apache-2.0) and others, which rosbags
lacks: facts of the packages that publish them."""

PARTS = {
    ".msg": ("",),
    ".srv": ("_Request", "_Response"),
    ".action": ("_Goal", "_Result", "_Feedback"),
}
"""The messages that a definition consists of."""

FOLLOW = "control_msgs/action/FollowJointTrajectory"
GRIPPER = "control_msgs/action/GripperCommand"
CANCEL = "action_msgs/srv/CancelGoal"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
POINT = "trajectory_msgs/msg/JointTrajectoryPoint"
COMMAND = "control_msgs/msg/GripperCommand"
UUID = "unique_identifier_msgs/msg/UUID"


MOVE = "moveit_msgs/action/MoveGroup"
EXECUTE = "moveit_msgs/action/ExecuteTrajectory"
SEQUENCE = "moveit_msgs/action/MoveGroupSequence"


def _definitions() -> Iterator[tuple[str, str]]:
    """The field lists of messages by their types, those of the services of actions included."""
    for file in DEFINITIONS.glob("*/*/*.*"):
        kind = "/".join([*file.parts[-3:-1], file.stem])
        for part, fields in zip(PARTS[file.suffix], file.read_text().split("---\n"), strict=True):
            yield kind + part, fields
    for action in (FOLLOW, GRIPPER):
        yield from _of_action(action)


def _of_action(action: str) -> Iterator[tuple[str, str]]:
    """The field lists of the services and the feedback topic that an action is made of."""
    yield f"{action}_SendGoal_Request", f"{UUID} goal_id\n{action}_Goal goal"
    yield f"{action}_SendGoal_Response", "bool accepted\nbuiltin_interfaces/msg/Time stamp"
    yield f"{action}_GetResult_Request", f"{UUID} goal_id"
    yield f"{action}_GetResult_Response", f"int8 status\n{action}_Result result"
    yield f"{action}_FeedbackMessage", f"{UUID} goal_id\n{action}_Feedback feedback"


def _table() -> Iterator[tuple[str, str]]:
    """The field lists of the interfaces of MoveIt and of the controller manager."""
    for line in (DEFINITIONS / "interfaces.txt").read_text().splitlines():
        kind, _, text = line.partition(": ")
        if not line.startswith("#"):
            parts = PARTS[f".{kind.split('/')[1]}"]
            for part, fields in zip(parts, text.split(" --- "), strict=True):
                yield kind + part, fields.replace("; ", "\n")
    for action in (MOVE, EXECUTE, SEQUENCE):
        yield from _of_action(action)


def _register(definitions: Iterator[tuple[str, str]]) -> None:
    for kind, fields in definitions:
        [parsed] = get_types_from_msg(fields, kind).values()
        TYPESTORE.register({kind: parsed})  # by its own name: rosbags has no folder `srv`


_register(_definitions())


@cache
def register_move_group() -> None:
    """Make the types of MoveIt and of the controller manager known, which takes 0.2 s."""
    _register(_table())


LATER_THAN_HUMBLE = {
    "moveit_msgs/msg/MoveItErrorCodes": ("message", "source"),
    "moveit_msgs/action/ExecuteTrajectory_Goal": ("controller_names",),
    "moveit_msgs/srv/GetCartesianPath_Request": (
        "max_velocity_scaling_factor", "max_acceleration_scaling_factor",
        "cartesian_speed_limited_link", "max_cartesian_speed",
    ),
}  # fmt: skip
"""The fields that messages of ROS 2 Humble do not have yet."""

INTRODUCTIONS = {"rmw_dds_common": 16, "rmw_dds_common_of_humble": 24}
"""Packages of the messages that introduce nodes, and the bytes of an identifier in each."""


def _introductions_of_humble() -> Iterator[tuple[str, str]]:
    package = "rmw_dds_common_of_humble/msg"
    yield f"{package}/Gid", f"uint8[{INTRODUCTIONS['rmw_dds_common_of_humble']}] data"
    names, gids = "string node_namespace\nstring node_name", f"{package}/Gid[]"
    endpoints = f"{gids} reader_gid_seq\n{gids} writer_gid_seq"
    yield f"{package}/NodeEntitiesInfo", f"{names}\n{endpoints}"
    nodes = f"{package}/NodeEntitiesInfo[] node_entities_info_seq"
    yield f"{package}/ParticipantEntitiesInfo", f"{package}/Gid gid\n{nodes}"


_register(_introductions_of_humble())


@cache
def _humble() -> Typestore:
    """The message types of ROS 2 Humble, as far as they differ in what is sent."""
    store, known = Typestore(), dict(TYPESTORE.fielddefs)
    for kind, later in LATER_THAN_HUMBLE.items():
        constants, fields = known[kind]
        known[kind] = constants, [field for field in fields if field[0] not in later]
    store.register(known)
    return store


def encoded(content: Any, kind: str, *, for_humble: bool = False) -> bytes:
    """A message as it is sent, to a node of ROS 2 Humble or of a later one."""
    is_other = for_humble and kind.startswith("moveit_msgs/")
    return bytes((_humble() if is_other else TYPESTORE).serialize_cdr(content, kind))


def decoded(payload: bytes, kind: str, *, of_humble: bool = False) -> Any:
    """The message of a serialised one; None where the bytes of another program are no such one.

    Bytes after the message do not count: rclpy's serialisation leaves some for each list element.
    """
    is_other = of_humble and kind.startswith("moveit_msgs/")
    store = _humble() if is_other else TYPESTORE
    known = store.get_msgdef(kind)
    readers = {b"\0\0": known.deserialize_cdr_be, b"\0\1": known.deserialize_cdr_le}
    with suppress(Exception):  # no kind of error is certain
        found = readers[payload[:2]](payload[4:], 0, known.cls, store)[0]
        names = [name for name, _ in known.fields]
        return message(kind, **{n: getattr(found, n) for n in names}) if is_other else found
    return None


def prepare(kind: str) -> None:
    """Let rosbags write the code of a type now, which takes some milliseconds."""
    TYPESTORE.deserialize_cdr(TYPESTORE.serialize_cdr(message(kind), kind), kind)


def stamp(seconds: float) -> Any:
    """A simulated time; the clock of the bridge begins at 0, as that of Gazebo."""
    return time_message(round(seconds * 1e9))


def header(seconds: float, frame_id: str = "") -> Any:
    """A simulated time, and the frame that the content is in."""
    return message("std_msgs/msg/Header", stamp=stamp(seconds), frame_id=frame_id)


def seconds(moment: Any) -> float:
    """A stamp or a duration in seconds."""
    return moment.sec + moment.nanosec * 1e-9
