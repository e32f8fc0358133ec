"""The topics of a bag: names, types, and the QoS with which viewers find what was latched."""

from __future__ import annotations

import re
from dataclasses import dataclass

from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

PREFIX = "/armharness"
FOREVER = QosTime(sec=9223372036, nsec=854775807)  # as rmw writes an infinite duration


@dataclass(frozen=True)
class Topic:
    """Where messages of one type go.

    Attributes:
        depth: The depth of the publisher's history.
        is_latched: Late subscribers get the last message too (transient local).
        is_reliable: Else best effort, as sensors publish.
    """

    name: str
    msgtype: str
    depth: int = 10
    is_latched: bool = False
    is_reliable: bool = True

    def qos(self) -> Qos:
        """What its publisher offers."""
        return Qos(
            QosHistory.KEEP_LAST,
            self.depth,
            QosReliability.RELIABLE if self.is_reliable else QosReliability.BEST_EFFORT,
            QosDurability.TRANSIENT_LOCAL if self.is_latched else QosDurability.VOLATILE,
            FOREVER,
            FOREVER,
            QosLiveliness.AUTOMATIC,
            FOREVER,
            False,
        )


def _latched(name: str, msgtype: str) -> Topic:
    return Topic(name, msgtype, depth=1, is_latched=True)


CLOCK = Topic("/clock", "rosgraph_msgs/msg/Clock", depth=1, is_reliable=False)
ROBOT_DESCRIPTION = _latched("/robot_description", "std_msgs/msg/String")
TF_STATIC = _latched("/tf_static", "tf2_msgs/msg/TFMessage")
TF = Topic("/tf", "tf2_msgs/msg/TFMessage", depth=100)
JOINT_STATES = Topic("/joint_states", "sensor_msgs/msg/JointState")
JOINT_COMMANDS = Topic("/joint_commands", "sensor_msgs/msg/JointState")
PLANNED_TRAJECTORY = _latched("/planned_trajectory", "trajectory_msgs/msg/JointTrajectory")
DISPLAY_PLANNED_PATH = _latched("/display_planned_path", "moveit_msgs/msg/DisplayTrajectory")
SCENE_MARKERS = _latched("/scene_markers", "visualization_msgs/msg/MarkerArray")
TCP_PATH = Topic("/tcp_path", "nav_msgs/msg/Path")
EVENTS = Topic(f"{PREFIX}/events", "std_msgs/msg/String", depth=100)
ROSOUT = Topic("/rosout", "rcl_interfaces/msg/Log", depth=1000)


@dataclass(frozen=True)
class CameraTopics:
    """What a camera publishes, as image_transport names it."""

    image: Topic
    compressed: Topic
    info: Topic
    depth: Topic


def topic_word(name: str) -> str:
    """A name as a part of a topic's; what no topic may hold becomes an underscore."""
    return re.sub(r"[^A-Za-z0-9_]|^(?=\d)", "_", name)


def camera_topics(camera: str) -> CameraTopics:
    """Topics below the camera's name, as on the bridge to ROS 2 and in the lesson."""
    base = f"/{topic_word(camera)}"
    return CameraTopics(
        image=Topic(f"{base}/image", "sensor_msgs/msg/Image", is_reliable=False),
        compressed=Topic(
            f"{base}/image/compressed", "sensor_msgs/msg/CompressedImage", is_reliable=False
        ),
        info=Topic(f"{base}/camera_info", "sensor_msgs/msg/CameraInfo"),
        depth=Topic(f"{base}/depth/image", "sensor_msgs/msg/Image", is_reliable=False),
    )
