"""Recordings as other programs make them, written by Foxglove's writer from a harness run.

A student's Gazebo with MoveIt: the arm's and the gripper's controllers publish joint states of
their own, in alphabetical order, without the joints that follow others; Gazebo's poses come over
the bridge as one TFMessage a tick; stamps are simulated time, the recorder has the wall clock.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer
from rosbags.typesys import Stores, get_typestore

from harness.core.resources import data_folder
from harness.plugins.grading.bag.content import BagTopics

STORE = get_typestore(Stores.ROS2_JAZZY)
POSES = "/world/default/dynamic_pose/info"
SCENARIO = data_folder("scenarios") / "grading/pick_and_place.scenario.yaml"
GAZEBO = BagTopics(objects=(POSES,))
NEEDS_CONTACTS = " is grasped"
GAZEBO_STARTED = 123.4
"""Simulated time at which the recording begins [s]."""
WALL_CLOCK = 1_700_000_000.0
"""When that was, by the recorder's clock [s]."""


@dataclass
class Message:
    topic: str
    msgtype: str
    stamp: float
    logged: float
    content: dict


@dataclass
class Recording:
    """What is to be written; tests change it before that."""

    messages: list[Message] = field(default_factory=list)

    def add(self, topic, msgtype, time, content, *, stamp=None, logged=None):
        self.messages.append(
            Message(
                topic,
                msgtype,
                GAZEBO_STARTED + time if stamp is None else stamp,
                WALL_CLOCK + 2 * time if logged is None else logged,
                content,
            )
        )

    def of(self, topic):
        return [message for message in self.messages if message.topic == topic]

    def without(self, *topics):
        return Recording([m for m in self.messages if m.topic not in topics])

    def write(self, path: Path, compression=CompressionType.ZSTD, chunk_size=2**20):
        with path.open("wb") as file:
            writer = Writer(file, chunk_size=chunk_size, compression=compression)
            schemas = {}
            for message in self.messages:
                if message.msgtype not in schemas:
                    text, _ = STORE.generate_msgdef(message.msgtype, ros_version=2)
                    schemas[message.msgtype] = writer.register_msgdef(message.msgtype, text)
                content = stamped(message.content, message.stamp)
                logged = round(message.logged * 1e9)
                writer.write_message(message.topic, schemas[message.msgtype], content, logged)
            writer.finish()
        return path


def stamped(content, time):
    """The content with every header's stamp set."""
    if isinstance(content, list):
        return [stamped(each, time) for each in content]
    if not isinstance(content, dict):
        return content
    changed = {key: stamped(value, time) for key, value in content.items()}
    if "header" in changed:
        sec, nanosec = divmod(round(time * 1e9), 10**9)
        changed["header"] = {**changed["header"], "stamp": {"sec": sec, "nanosec": nanosec}}
    return changed


def header(frame=""):
    return {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": frame}


def vector(values):
    return dict(zip("xyz", map(float, values), strict=True))


def quaternion(wxyz):
    w, x, y, z = map(float, wxyz)
    return {"x": x, "y": y, "z": z, "w": w}


def transform(parent, child, pose):
    return {
        "header": header(parent),
        "child_frame_id": child,
        "transform": {"translation": vector(pose[:3]), "rotation": quaternion(pose[3:])},
    }


def joint_state(signals, row, columns):
    """Of some joints, in the order of their names."""
    names = sorted(columns)
    places = [columns[name] for name in names]
    return {
        "header": header(),
        "name": names,
        "position": signals.joint_positions[row, places].tolist(),
        "velocity": signals.joint_velocities[row, places].tolist(),
        "effort": signals.joint_efforts[row, places].tolist(),
    }


def students_recording(run, rate=50.0):
    """The run as a student's recorder would have seen it."""
    recording = Recording()
    columns = {joint.name: column for column, joint in enumerate(run.robot.movable_joints)}
    arm = {name: columns[name] for name in run.robot.arm_joints}
    hand = {run.robot.gripper.joint: columns[run.robot.gripper.joint]}
    times = run.signals.times
    rows = np.searchsorted(times, np.arange(0, times[-1], 1 / rate) - 1e-9)
    for number, row in enumerate(rows):
        time = float(times[row])
        state = "sensor_msgs/msg/JointState"
        recording.add("/joint_states", state, time, joint_state(run.signals, row, arm))
        if number % 2 == 0:
            recording.add("/joint_states", state, time, joint_state(run.signals, row, hand))
        moved = [
            transform("", name, poses[row])
            for name, poses in run.signals.object_poses.items()
            if name in ("green_cylinder", "red_box", "blue_box", "beer_0", "coke_can_steel")
        ]
        recording.add(POSES, "tf2_msgs/msg/TFMessage", time, {"transforms": moved})
    return recording


def statuses(grade):
    return {row.verdict.expectation: row.verdict.status for row in grade.rows}


def status_of(grade, word):
    [status] = [value for key, value in statuses(grade).items() if word in key]
    return status
