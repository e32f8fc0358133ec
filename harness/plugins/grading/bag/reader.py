"""Reads messages into content, with bounded memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from harness.core.limits import BAG_NUMBERS
from harness.core.untrusted_json import parse_json
from harness.plugins.grading.bag.content import BagContent, BagTopics, RecordedTrack, Tracks
from harness.plugins.grading.bag.message_files import RawMessage, bag_error
from harness.plugins.grading.bag.storage import bag_files, messages

LATEST = 2**63 - 1  # latest time of a message [ns]
NEW_KEY = 200  # numbers that a new frame or set of joints counts for, besides its characters

TF = "tf2_msgs/msg/TFMessage"
FRAMES = {"/tf": False, "/tf_static": True}  # topics of the frame tree: whether they are static

MODEL_STATES = "gazebo_msgs/msg/ModelStates"
TYPES, ROS1_TYPES = get_typestore(Stores.ROS2_JAZZY), get_typestore(Stores.ROS1_NOETIC)
ROS1_TYPES.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TF))
for _store in (TYPES, ROS1_TYPES):
    _store.register(
        get_types_from_msg(
            "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist", MODEL_STATES
        )
    )
NAMED_POSES = (TF, MODEL_STATES)  # types whose messages contain object names
SINGLE_POSES = (
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TransformStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "nav_msgs/msg/Odometry",
)
"""Types of topics with poses of one object."""


def read_bag(path: Path, topics: BagTopics) -> BagContent:
    """Read the usable content of a recording.

    Raises:
        SpecError: It cannot be read, is too large, or lacks a named topic with poses.
    """
    files = bag_files(path)
    content = BagContent(notes=list(files.notes))
    reader = _Reader(path, topics, content)
    for message in messages(files):
        reader.take(message)
    reader.finish()
    return content


class _Unusable(Exception):
    """Why a message cannot be used."""


class _Reader:
    def __init__(self, path: Path, topics: BagTopics, content: BagContent) -> None:
        self._path, self._topics, self._content = path, topics, content
        self._objects = {topic: name for name, topic in topics.object_poses.items()}
        self._malformed: dict[str, list[str]] = {}
        self._kept = 0

    def take(self, message: RawMessage) -> None:
        """Add the content of a message."""
        msgtype, count = self._content.topics.get(message.topic, (message.msgtype, 0))
        self._content.topics[message.topic] = (msgtype, count + 1)
        keep = self._handler(message)
        if keep is None:
            return
        try:
            if message.log_time > LATEST:
                raise _Unusable("its time is beyond the year 2262")  # noqa: TRY301
            read = ROS1_TYPES.deserialize_ros1 if message.is_ros1 else TYPES.deserialize_cdr
            keep(read(message.data, message.msgtype), message)
        except Exception as error:  # noqa: BLE001 - a damaged message may raise anything
            reason = str(error) if isinstance(error, _Unusable) else "it is damaged"
            self._malformed.setdefault(message.topic, []).append(reason)
        if self._kept > BAG_NUMBERS:
            raise bag_error(
                self._path,
                f"holds more than {BAG_NUMBERS} numbers of joints and frames",
                "cut out what is to be graded, with `ros2 bag convert` for example",
            )

    def finish(self) -> None:
        """Refuse topics that cannot be used; add notes on messages that are left out."""
        known = self._content.topics
        for topic in (*self._topics.objects, *self._topics.object_poses.values()):
            if topic not in known:
                raise bag_error(self._path, f"has no topic {topic}", _offer(known))
            types = NAMED_POSES if topic in self._topics.objects else SINGLE_POSES
            if known[topic][0] not in types:
                reason = f"{topic} is of type {known[topic][0]}, which has no poses of objects"
                raise bag_error(self._path, reason, f"supported types: {', '.join(types)}")
        for topic, reasons in sorted(self._malformed.items()):
            count, whole = len(reasons), known[topic][1]
            if count == whole:
                raise bag_error(self._path, f"no message of {topic} can be read: {reasons[0]}")
            reason = (
                f"{count} of {whole} messages of {topic} cannot be read; the first: {reasons[0]}"
            )
            self._content.notes.append(reason)

    def _handler(self, message: RawMessage) -> Callable[[Any, RawMessage], None] | None:
        arm, topic = self._of_arm(message.topic)
        msgtype = message.msgtype
        if topic in self._topics.objects:
            return {TF: self._named_frames, MODEL_STATES: self._models}.get(msgtype)
        if topic in self._objects:
            return self._pose if msgtype in SINGLE_POSES else None
        match topic, msgtype:
            case (self._topics.joint_states, "sensor_msgs/msg/JointState"):
                return partial(self._put_joints, self._content.joints, arm)
            case ("/joint_commands", "sensor_msgs/msg/JointState"):
                return partial(self._put_joints, self._content.commands, arm)
            case ("/tf" | "/tf_static", "tf2_msgs/msg/TFMessage"):
                return self._frames
            case (_, "geometry_msgs/msg/WrenchStamped") if self._topics.reads_wrenches:
                return self._wrench
            case ("/armharness/events", "std_msgs/msg/String"):
                return self._event
        return None

    def _of_arm(self, topic: str) -> tuple[str, str]:
        """The arm that a topic of joints is of, and the topic without its name."""
        for arm in self._topics.arms:
            whole = topic.removeprefix(f"/{arm}")
            if whole in (self._topics.joint_states, "/joint_commands") and whole != topic:
                return arm, whole
        return "", topic

    def _put_joints(self, tracks: Tracks, arm: str, content: Any, message: RawMessage) -> None:
        names = tuple(self._joint(name, arm) for name in content.name)
        count = len(names)
        if not count:
            raise _Unusable("it names no joint")
        if len(set(names)) < count:
            raise _Unusable(f"it names {next(n for n in names if names.count(n) > 1)} twice")
        parts: list[Sequence[float]] = []
        for values in (content.position, content.velocity, content.effort):
            if len(values) not in (0, count):
                raise _Unusable(f"it has {count} names and {len(values)} values")
            parts.append(values if len(values) else [math.nan] * count)
        row = [float(value) for part in parts for value in part]
        if any(map(math.isinf, row)):
            raise _Unusable("it has infinite numbers")
        self._put(self._track(tracks, names, 3 * count), content.header, message, row)

    def _joint(self, name: str, arm: str) -> str:
        """The scenario's name of a joint, on the topic of an arm or of the whole robot."""
        known = self._topics.joint_names
        found = known[name] if name in known else name.removeprefix(self._topics.joint_prefix)
        is_short = arm and f"{arm}_{found}" in self._topics.arms[arm]
        return f"{arm}_{found}" if is_short else found

    def _frames(self, content: Any, message: RawMessage) -> None:
        is_static = FRAMES[message.topic]
        edges = self._content.static_edges if is_static else self._content.edges
        self._put_transforms(edges, content.transforms, message)

    def _named_frames(self, content: Any, message: RawMessage) -> None:
        self._put_transforms(self._content.objects, content.transforms, message)

    def _put_transforms(
        self, edges: Tracks, transforms: Sequence[Any], message: RawMessage
    ) -> None:
        for each in transforms:
            pose = each.transform
            prefix = self._topics.joint_prefix
            edge = (
                _frame(each.header.frame_id).removeprefix(prefix),
                _frame(each.child_frame_id).removeprefix(prefix),
            )
            self._put_pose(edges, edge, each.header, message, pose.translation, pose.rotation)

    def _models(self, content: Any, message: RawMessage) -> None:
        for name, pose in zip(content.name, content.pose, strict=True):
            edge = ("world", _frame(name))
            self._put_pose(
                self._content.objects, edge, None, message, pose.position, pose.orientation
            )

    def _pose(self, content: Any, message: RawMessage) -> None:
        name = self._objects[message.topic]
        edge = (_frame(content.header.frame_id), name)
        inner = getattr(content, "pose", None) or content.transform
        pose = getattr(inner, "pose", inner)
        position = getattr(pose, "position", None) or pose.translation
        orientation = getattr(pose, "orientation", None) or pose.rotation
        self._put_pose(self._content.objects, edge, content.header, message, position, orientation)

    def _put_pose(
        self,
        edges: Tracks,
        edge: tuple[str, str],
        header: Any,
        message: RawMessage,
        position: Any,
        orientation: Any,
    ) -> None:
        quat = (orientation.w, orientation.x, orientation.y, orientation.z)
        length = math.hypot(*quat) or math.nan
        row = [position.x, position.y, position.z, *(value / length for value in quat)]
        if not all(map(math.isfinite, row)) or abs(length - 1) > 0.01:
            raise _Unusable("its numbers are no pose: not finite, or no unit quaternion")
        self._put(self._track(edges, edge, 7), header, message, row)

    def _wrench(self, content: Any, message: RawMessage) -> None:
        force, torque = content.wrench.force, content.wrench.torque
        row = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
        if not all(map(math.isfinite, row)):
            raise _Unusable("its numbers are not finite")
        frame = str(content.header.frame_id).lstrip("/").removeprefix(self._topics.joint_prefix)
        track = self._track(self._content.wrenches, (message.topic, frame), 6)
        self._put(track, content.header, message, row)

    def _event(self, content: Any, message: RawMessage) -> None:
        event = parse_json(content.data)
        if not isinstance(event, dict):
            raise _Unusable("it is no event")
        self._kept += NEW_KEY + len(content.data)
        self._content.events.append((message.log_time, event))

    def _track(self, tracks: Tracks, names: tuple[str, ...], width: int) -> RecordedTrack:
        """The track of some names; a new one counts towards the memory limit."""
        if names not in tracks:
            self._kept += NEW_KEY + sum(map(len, names))
            tracks[names] = RecordedTrack(width)
        return tracks[names]

    def _put(
        self, track: RecordedTrack, header: Any, message: RawMessage, row: Sequence[float]
    ) -> None:
        stamp = 0 if header is None else header.stamp.sec * 10**9 + header.stamp.nanosec
        track.logged.append(message.log_time)
        track.stamps.append(stamp)
        track.numbers.extend(row)
        self._kept += len(row) + 2


def _frame(name: str) -> str:
    """A frame's name without a leading slash; an empty name is the world, as in Gazebo."""
    return str(name).lstrip("/") or "world"


def _offer(topics: Mapping[str, tuple[str, int]]) -> str:
    useful = [
        name for name, (kind, _) in sorted(topics.items()) if kind in (*NAMED_POSES, *SINGLE_POSES)
    ]
    return (
        f"topics with poses there: {', '.join(useful)}" if useful else "it has no topic with poses"
    )
