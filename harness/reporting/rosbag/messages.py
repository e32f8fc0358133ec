"""ROS 2 messages: their types, and how the program's values become theirs.

Interface definitions are facts of the packages that publish them; those of moveit_msgs, which
rosbags does not carry, are given here field by field.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

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
_TYPES: Any = TYPESTORE.types

Time: Any = _TYPES["builtin_interfaces/msg/Time"]
Duration: Any = _TYPES["builtin_interfaces/msg/Duration"]
Header: Any = _TYPES["std_msgs/msg/Header"]
String: Any = _TYPES["std_msgs/msg/String"]
ColorRGBA: Any = _TYPES["std_msgs/msg/ColorRGBA"]
Point: Any = _TYPES["geometry_msgs/msg/Point"]
Vector3: Any = _TYPES["geometry_msgs/msg/Vector3"]
Quaternion: Any = _TYPES["geometry_msgs/msg/Quaternion"]
Pose: Any = _TYPES["geometry_msgs/msg/Pose"]
PoseStamped: Any = _TYPES["geometry_msgs/msg/PoseStamped"]
Transform: Any = _TYPES["geometry_msgs/msg/Transform"]
TransformStamped: Any = _TYPES["geometry_msgs/msg/TransformStamped"]
TFMessage: Any = _TYPES["tf2_msgs/msg/TFMessage"]
JointState: Any = _TYPES["sensor_msgs/msg/JointState"]
MultiDOFJointState: Any = _TYPES["sensor_msgs/msg/MultiDOFJointState"]
CompressedImage: Any = _TYPES["sensor_msgs/msg/CompressedImage"]
Image: Any = _TYPES["sensor_msgs/msg/Image"]
CameraInfo: Any = _TYPES["sensor_msgs/msg/CameraInfo"]
RegionOfInterest: Any = _TYPES["sensor_msgs/msg/RegionOfInterest"]
Clock: Any = _TYPES["rosgraph_msgs/msg/Clock"]
Log: Any = _TYPES["rcl_interfaces/msg/Log"]
Path: Any = _TYPES["nav_msgs/msg/Path"]
JointTrajectory: Any = _TYPES["trajectory_msgs/msg/JointTrajectory"]
JointTrajectoryPoint: Any = _TYPES["trajectory_msgs/msg/JointTrajectoryPoint"]
MultiDOFJointTrajectory: Any = _TYPES["trajectory_msgs/msg/MultiDOFJointTrajectory"]
Marker: Any = _TYPES["visualization_msgs/msg/Marker"]
MarkerArray: Any = _TYPES["visualization_msgs/msg/MarkerArray"]
MeshFile: Any = _TYPES["visualization_msgs/msg/MeshFile"]
RobotState: Any = _TYPES["moveit_msgs/msg/RobotState"]
RobotTrajectory: Any = _TYPES["moveit_msgs/msg/RobotTrajectory"]
DisplayTrajectory: Any = _TYPES["moveit_msgs/msg/DisplayTrajectory"]

NOTHING = np.zeros(0)


def nanoseconds(seconds: float) -> int:
    """A simulation time on the bag's clock [ns]."""
    return EPOCH + round(seconds * 1e9)


def stamp(seconds: float) -> Any:
    """A simulation time as a stamp."""
    whole, rest = divmod(nanoseconds(seconds), 10**9)
    return Time(sec=whole, nanosec=rest)


def duration(seconds: float) -> Any:
    """A length of time."""
    whole, rest = divmod(round(seconds * 1e9), 10**9)
    return Duration(sec=whole, nanosec=rest)


def header(seconds: float, frame_id: str = "") -> Any:
    """A stamp and the frame that the content is in."""
    return Header(stamp=stamp(seconds), frame_id=frame_id)


def transform(pose: Sequence[float]) -> Any:
    """A pose xyz, quaternion wxyz as a Transform, whose quaternion is xyzw."""
    x, y, z, qw, qx, qy, qz = pose
    return Transform(
        translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)
    )


def pose_message(pose: Sequence[float]) -> Any:
    """A pose xyz, quaternion wxyz as a Pose, whose quaternion is xyzw."""
    x, y, z, qw, qx, qy, qz = pose
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))


def joint_state(
    time: float,
    names: list[str],
    positions: FloatArray,
    velocities: FloatArray = NOTHING,
    efforts: FloatArray = NOTHING,
) -> Any:
    """Joints by name; what is not given stays empty."""
    return JointState(
        header=header(time), name=names, position=positions, velocity=velocities, effort=efforts
    )
