"""Bags against ROS 2 itself: rclpy and its messages, as wheels, without a ROS installation."""

import importlib
import json
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader

from tests.plugins.ros.bag_runs import everything

pytestmark = [pytest.mark.needs_ros, pytest.mark.filterwarnings("ignore::DeprecationWarning")]
WITHOUT_WHEELS = {"tf2_msgs", "moveit_msgs"}
"""There are no wheels of these messages; the other readers decode them."""


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    return everything(tmp_path_factory.mktemp("everything"), bag=True) / "bag"


@pytest.fixture(scope="module")
def ros():
    """`rclpy.serialization`; the wheels put type descriptions below a `share` of their own."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return importlib.import_module("rclpy.serialization")
        except ImportError as error:
            pytest.fail(f"this needs the extra `ros`: pip install -e '.[test,ros]': {error}")


def message_class(msgtype):
    package, _, name = msgtype.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def raw_messages(bag):
    with (bag / "bag.mcap").open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if schema.name.split("/")[0] not in WITHOUT_WHEELS:
                yield schema.name, channel.topic, message.data


def test_rclpy_deserialises_every_message_that_it_has_a_type_for(ros, bag):
    seen = {}
    for msgtype, topic, data in raw_messages(bag):
        message = ros.deserialize_message(data, message_class(msgtype))
        seen.setdefault(topic, []).append(message)
    assert len(seen) >= 14
    states = seen["/joint_states"]
    assert len(states[0].name) == len(states[0].position) == len(states[0].effort) == 10
    assert states[0].header.stamp.sec == 1_800_000_000
    assert seen["/robot_description"][0].data.startswith("<?xml")
    assert json.loads(seen["/armharness/events"][-1].data)["event"] == "run_finished"
    assert seen["/scene_markers"][0].markers[0].action == 3
    grown = [len(path.poses) for path in seen["/tcp_path"]]
    assert grown == sorted(grown)
    depth = seen["/wrist/depth/image"][0]
    assert np.frombuffer(bytes(depth.data), "<f4").shape == (depth.height * depth.width,)


def test_what_rclpy_serialises_again_says_the_same(ros, bag):
    """Padding between fields may differ, so the bytes are read once more."""
    for number, (msgtype, _, data) in enumerate(raw_messages(bag)):
        if number % 53 == 0:
            kind = message_class(msgtype)
            message = ros.deserialize_message(data, kind)
            again = ros.deserialize_message(ros.serialize_message(message), kind)
            assert str(again) == str(message)


@pytest.mark.usefixtures("ros")
def test_type_hashes_are_those_of_ros(bag):
    about = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    compared = 0
    for topic in about["topics_with_message_count"]:
        package, kind, name = topic["topic_metadata"]["type"].split("/")
        file = Path(sys.prefix) / "share" / package / kind / f"{name}.json"
        if file.is_file():
            hashes = json.loads(file.read_text())["type_hashes"]
            known = {entry["type_name"]: entry["hash_string"] for entry in hashes}
            written = topic["topic_metadata"]["type_description_hash"]
            assert known[f"{package}/{kind}/{name}"] == written
            compared += 1
    assert compared >= 12
