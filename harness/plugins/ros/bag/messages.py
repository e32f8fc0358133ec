"""ROS 2 messages: their types, and how the program's values become theirs.

Interface definitions are facts of the packages that publish them; those of moveit_msgs, which
rosbags does not carry, are given here field by field.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray

EPOCH = 1_800_000_000 * 10**9
"""When simulation time 0 is on the bag's clock [ns]: a fixed moment, neither the wall clock nor 0,
which tf takes as "the latest there is"."""

DEFINITIONS = {
    "object_recognition_msgs/msg/ObjectType": "string key\nstring db",
    "moveit_msgs/msg/CollisionObject": (
        "std_msgs/Header header\ngeometry_msgs/Pose pose\nstring id\n"
        "object_recognition_msgs/ObjectType type\n"
        "shape_msgs/SolidPrimitive[] primitives\ngeometry_msgs/Pose[] primitive_poses\n"
        "shape_msgs/Mesh[] meshes\ngeometry_msgs/Pose[] mesh_poses\n"
        "shape_msgs/Plane[] planes\ngeometry_msgs/Pose[] plane_poses\n"
        "string[] subframe_names\ngeometry_msgs/Pose[] subframe_poses\n"
        "byte ADD=0\nbyte REMOVE=1\nbyte APPEND=2\nbyte MOVE=3\nbyte operation"
    ),
    "moveit_msgs/msg/AttachedCollisionObject": (
        "string link_name\nmoveit_msgs/CollisionObject object\nstring[] touch_links\n"
        "trajectory_msgs/JointTrajectory detach_posture\nfloat64 weight"
    ),
    "moveit_msgs/msg/RobotState": (
        "sensor_msgs/JointState joint_state\n"
        "sensor_msgs/MultiDOFJointState multi_dof_joint_state\n"
        "moveit_msgs/AttachedCollisionObject[] attached_collision_objects\nbool is_diff"
    ),
    "moveit_msgs/msg/RobotTrajectory": (
        "trajectory_msgs/JointTrajectory joint_trajectory\n"
        "trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory"
    ),
    "moveit_msgs/msg/DisplayTrajectory": (
        "string model_id\nmoveit_msgs/RobotTrajectory[] trajectory\n"
        "moveit_msgs/RobotState trajectory_start"
    ),
}
"""Of moveit_msgs (BSD-3-Clause) and object_recognition_msgs (BSD-3-Clause), as of Jazzy."""


def _typestore() -> Typestore:
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, name))
    return store


TYPESTORE = _typestore()
TYPES: Any = TYPESTORE.types


def message(kind: str, /, **fields: Any) -> Any:
    """A message of a type; fields that are left out are zero or empty."""
    for name, definition in TYPESTORE.fielddefs[kind][1]:
        if name not in fields:
            fields[name] = _default(definition)
    return TYPES[kind](**fields)


def _default(kind: Any) -> Any:
    node, detail = kind
    if node == Nodetype.NAME:
        return message(detail)
    if node == Nodetype.BASE:
        base = detail[0]
        return (
            "" if base == "string" else False if base == "bool" else 0.0 if "float" in base else 0
        )
    element, size = detail
    if element[0] == Nodetype.BASE and element[1][0] != "string":
        return np.zeros(size or 0, dtype=np.dtype(element[1][0].replace("octet", "uint8")))
    return [_default(element) for _ in range(size or 0)]


def time_message(nanoseconds: int, kind: str = "Time") -> Any:
    """A moment as a Time, or a span as a Duration."""
    whole, rest = divmod(nanoseconds, 10**9)
    return message(f"builtin_interfaces/msg/{kind}", sec=whole, nanosec=rest)


def nanoseconds(seconds: float) -> int:
    """A simulation time on the bag's clock [ns]."""
    return EPOCH + round(seconds * 1e9)


def stamp(seconds: float) -> Any:
    """A simulation time as a stamp."""
    return time_message(nanoseconds(seconds))


def duration(seconds: float) -> Any:
    """A length of time."""
    return time_message(round(seconds * 1e9), "Duration")


def header(seconds: float, frame_id: str = "") -> Any:
    """A stamp and the frame that the content is in."""
    return message("std_msgs/msg/Header", stamp=stamp(seconds), frame_id=frame_id)


def transform(pose: Sequence[float]) -> Any:
    """A pose xyz, quaternion wxyz as a Transform, whose quaternion is xyzw."""
    rotation = message("geometry_msgs/msg/Quaternion", **_turn(pose))
    return message("geometry_msgs/msg/Transform", translation=vector(pose), rotation=rotation)


def pose_message(pose: Sequence[float]) -> Any:
    """A pose xyz, quaternion wxyz as a Pose, whose quaternion is xyzw."""
    orientation = message("geometry_msgs/msg/Quaternion", **_turn(pose))
    return message("geometry_msgs/msg/Pose", position=point(pose), orientation=orientation)


def point(xyz: Sequence[float]) -> Any:
    """The first three numbers as a Point."""
    return message("geometry_msgs/msg/Point", x=xyz[0], y=xyz[1], z=xyz[2])


def vector(xyz: Sequence[float]) -> Any:
    """The first three numbers as a Vector3."""
    return message("geometry_msgs/msg/Vector3", x=xyz[0], y=xyz[1], z=xyz[2])


def _turn(pose: Sequence[float]) -> dict[str, float]:
    return dict(zip("wxyz", pose[3:], strict=True))


def trajectory_message(plan: JointTrajectory, **fields: Any) -> Any:
    """A trajectory_msgs/JointTrajectory, with other fields such as its header."""
    rows = zip(plan.times, plan.positions, plan.velocities, plan.accelerations, strict=True)
    points = [
        message(
            "trajectory_msgs/msg/JointTrajectoryPoint",
            positions=positions,
            velocities=velocities,
            accelerations=accelerations,
            time_from_start=duration(float(time)),
        )
        for time, positions, velocities, accelerations in rows
    ]
    names = list(plan.joint_names)
    return message(
        "trajectory_msgs/msg/JointTrajectory", joint_names=names, points=points, **fields
    )


def joint_state(
    time: float, names: Sequence[str], positions: FloatArray, **others: FloatArray
) -> Any:
    """Joints by name; `velocity` and `effort` stay empty where they are not given."""
    return message(
        "sensor_msgs/msg/JointState", header=header(time), name=names, position=positions, **others
    )
