"""Bags of ROS 1, written by rosbags, and robots whose recorded names differ from the scenario's."""

import json
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.bag.ros1_messages import ros1_messages
from harness.plugins.grading.grade import grade_bag
from tests.plugins.grading.hand_made import JOINTS, SCENARIO, box_pose

ROS1 = get_typestore(Stores.ROS1_NOETIC)
TF, OLD_TF = "tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"
for name in (TF, OLD_TF):
    ROS1.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", name))
TURNED, UPRIGHT = "joints: {positions: {joint1: 0.6}, tolerance: 0.01}", "upright: box"
STARTED = 1_700_000_000 * 10**9


def message(kind, **fields):
    return ROS1.types[kind](**fields)


def header(time, frame=""):
    stamp = STARTED + round(time * 1e9)
    moment = message("builtin_interfaces/msg/Time", sec=stamp // 10**9, nanosec=stamp % 10**9)
    return message("std_msgs/msg/Header", seq=7, stamp=moment, frame_id=frame)


def joints(time, names):
    values = np.zeros(len(names))
    values[0] = 0.3 * min(time, 2.0)
    return message("sensor_msgs/msg/JointState", header=header(time), name=names, position=values,
                   velocity=np.zeros(0), effort=np.zeros(0))  # fmt: skip


def box(time, kind):
    x, y, z, qw, qx, qy, qz = box_pose()
    pose = message("geometry_msgs/msg/Transform",
                   translation=message("geometry_msgs/msg/Vector3", x=x, y=y, z=z),
                   rotation=message("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=qw),
                   )  # fmt: skip
    placed = message("geometry_msgs/msg/TransformStamped", header=header(time, "world"),
                     child_frame_id="box", transform=pose)  # fmt: skip
    return message(kind, transforms=[placed])


def write(path, *, names=JOINTS, compression=None, tf=TF):
    """Three seconds of an arm that turns by 0.6 rad next to a box."""
    writer = Writer(path)
    if compression:
        writer.set_compression(compression)
    with writer as bag:
        states = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=ROS1)
        frames = bag.add_connection("/tf", tf, typestore=ROS1)
        for time in np.arange(0, 3.001, 0.02):
            for topic, content in ((states, joints(time, list(names))), (frames, box(time, tf))):
                data = ROS1.serialize_ros1(content, topic.msgtype)
                bag.write(topic, STARTED + round(time * 1e9), data)
    return path


def scenario(folder):
    file = folder / "made.scenario.yaml"
    file.write_text(f"{SCENARIO}  - {TURNED}\n  - {UPRIGHT}\n")
    return file


def outcomes(folder, bag, topics=None):
    return [row.verdict.status for row in grade_bag(scenario(folder), bag, topics).rows]


@pytest.mark.parametrize("compression", [None, *Writer.CompressionFormat])
@pytest.mark.parametrize("tf", [TF, OLD_TF])
def test_a_bag_of_ros_1_is_graded(tmp_path, compression, tf):
    bag = write(tmp_path / "arm.bag", compression=compression, tf=tf)
    assert outcomes(tmp_path, bag) == ["passed", "passed"]


def test_a_bag_whose_recorder_was_killed_and_other_files_say_what_is_wrong(tmp_path):
    whole = write(tmp_path / "arm.bag").read_bytes()
    cut = tmp_path / "cut.bag"
    for count, reason in ((len(whole) // 2, "is cut off after"), (20, "is cut off after"),
                          (5, "is no ROS 1 bag of format 2.0"), (0, "is empty")):  # fmt: skip
        cut.write_bytes(whole[:count])
        with pytest.raises(SpecError, match=reason):
            outcomes(tmp_path, cut)
    cut.write_bytes(whole.replace(b"compression=none", b"compression=rar_"))
    with pytest.raises(SpecError, match="known: bz2, lz4"):
        outcomes(tmp_path, cut)
    cut.write_bytes(whole[:13] + b"\xff" * 8)
    with pytest.raises(SpecError, match="has a record of 4294967295 bytes"):
        outcomes(tmp_path, cut)


@pytest.mark.nightly
def test_damage_of_any_byte_is_an_error_of_the_file_or_changes_a_message(tmp_path):
    whole = write(tmp_path / "arm.bag", compression=Writer.CompressionFormat.BZ2).read_bytes()
    rng, damaged = np.random.default_rng(0), tmp_path / "damaged.bag"
    for place in rng.integers(0, len(whole), 200):
        content = bytearray(whole)
        content[place] ^= 1 << rng.integers(8)
        damaged.write_bytes(content)
        with suppress(SpecError):
            list(ros1_messages(damaged, damaged))


@pytest.mark.parametrize(
    ("recorded", "options"),
    [
        (lambda name: f"left/{name}", ["--joint-prefix", "left/"]),
        (lambda name: f"arm_1_{name}", ["--joint-prefix", "arm_1_"]),
        (lambda name: name.replace("joint1", "base"), ["--joint", "joint1=base"]),
        (
            lambda name: f"r_{name}".replace("r_joint1", "waist"),
            ["--joint-prefix", "r_", "--joint", "joint1=waist"],
        ),
    ],
)
def test_joints_are_read_under_the_names_of_the_recording(tmp_path, capsys, recorded, options):
    bag = write(tmp_path / "arm.bag", names=[recorded(name) for name in JOINTS])
    arguments = ["grade", str(scenario(tmp_path)), str(bag), "--json", *options]
    assert main(arguments) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["verdict"]["status"] for row in rows] == ["passed", "passed"]


def test_a_prefix_that_all_joints_have_is_proposed(tmp_path):
    bag = write(tmp_path / "arm.bag", names=[f"left_{name}" for name in JOINTS])
    with pytest.raises(SpecError, match="--joint-prefix left_"):
        outcomes(tmp_path, bag)
    assert outcomes(tmp_path, bag, replace(BagTopics(), joint_prefix="left_")) == ["passed"] * 2


def test_a_name_for_no_joint_of_the_robot_is_refused(tmp_path):
    bag = write(tmp_path / "arm.bag")
    with pytest.raises(SpecError, match="the robot has no joint 'elbow'"):
        outcomes(tmp_path, bag, replace(BagTopics(), joint_names={"joint2": "elbow"}))
