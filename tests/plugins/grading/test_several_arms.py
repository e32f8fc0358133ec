"""Recordings of a robot with several arms: one topic of joints, or one for each arm."""

import math

import pytest

from harness.plugins.grading.bag.content import BagTopics
from tests.plugins.grading.hand_made import grade, times
from tests.plugins.grading.recordings import Recording, header
from tests.steps.test_several_arms import PAIR

UR = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
ARMS = PAIR.replace(", gripper: rh_p12_rn_a", "")
SCENARIO = f"scenario: two arms\n{ARMS}steps:\n  - external: {{}}\nexpect:\n"
LINES = (
    "eventually: {joints: {positions: {left_elbow_joint: 0.6}}}",
    "eventually: {joints: {positions: {right_elbow_joint: 0.3}}}",
    "clearance: {between: [left, right], at_least: 5 cm}",
)


def add(recording, topic, prefixes, rate=50):
    """Joint states in which the left elbow moves twice as far as the right one."""
    names = [f"{prefix}{joint}_joint" for prefix in prefixes for joint in UR]
    is_left = "left" in topic or "left_" in prefixes
    for time in times(rate):
        part = 0.3 * (1 - math.cos(math.pi * min(time / 2, 1))) / 2
        ways = [part if not is_left else 2 * part, part][: len(prefixes)]
        rows = [value for way in ways for value in (0.0, -1.5, way, 0.0, 0.0, 0.0)]
        content = {
            "header": header(),
            "name": names,
            "position": rows,
            "velocity": [],
            "effort": [],
        }
        recording.add(topic, "sensor_msgs/msg/JointState", float(time), content)
    return recording


def verdicts(recording, folder):
    found = grade(recording, folder, *LINES, topics=BagTopics(), scenario=SCENARIO)
    return {row.verdict.status for row in found.rows}


@pytest.mark.parametrize(("left", "right"), [("", ""), ("left_", "right_"), ("", "right_")])
def test_each_arm_has_a_topic(left, right, tmp_path):
    recording = add(add(Recording(), "/left/joint_states", [left]), "/right/joint_states", [right])
    assert verdicts(recording, tmp_path) == {"passed"}


def test_both_arms_are_on_one_topic(tmp_path):
    recording = add(Recording(), "/joint_states", ["left_", "right_"])
    assert verdicts(recording, tmp_path) == {"passed"}


def test_topics_at_different_rates(tmp_path):
    recording = add(Recording(), "/left/joint_states", [""], rate=100)
    assert verdicts(add(recording, "/right/joint_states", [""], rate=40), tmp_path) == {"passed"}


def test_exchanged_topics_are_another_motion(tmp_path):
    recording = add(Recording(), "/left/joint_states", ["left_"])
    for message in recording.messages:
        message.topic = "/right/joint_states"
        message.content["name"] = [n.removeprefix("left_") for n in message.content["name"]]
    found = grade(recording, tmp_path, *LINES, topics=BagTopics(), scenario=SCENARIO)
    assert [row.verdict.status for row in found.rows][:1] != ["passed"]
