"""Frames, senders and joints of recordings that contradict each other or another robot."""

import numpy as np
import pytest

from harness.core.pose_arrays import relative, turn_between
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.grade import grade_bag
from harness.plugins.ros.bag.write import write_bag
from harness.recording.link_poses import replayed_link_poses
from tests.plugins.grading.recordings import (
    GAZEBO,
    POSES,
    SCENARIO,
    header,
    joint_state,
    quaternion,
    status_of,
    transform,
    vector,
)


@pytest.mark.nightly
def test_joints_that_follow_another_are_where_that_one_puts_them(recording, stored, tmp_path):
    run = grade_bag(SCENARIO, recording.write(tmp_path / "student.mcap"), GAZEBO).run
    followers = [n for n, joint in enumerate(run.robot.movable_joints) if joint.is_mimic]
    rows = np.searchsorted(stored.run.signals.times, run.signals.times - 1e-6)
    assert len(followers) == 3
    assert np.allclose(
        run.signals.joint_positions[:, followers],
        stored.run.signals.joint_positions[rows][:, followers],
        atol=0.05,
    )
    here, there = run.signals.tcp_pose, stored.run.signals.tcp_pose[rows]
    assert np.allclose(here[:, :3], there[:, :3], atol=1e-6)
    assert turn_between(here[:, 3:], there[:, 3:]).max() < 1e-6


def test_one_topic_an_object_does_as_well(recording, stored, tmp_path):
    poses = stored.run.signals.object_poses["green_cylinder"]
    times = stored.run.signals.times
    blind = recording.without(POSES)
    for row in range(0, len(times), 20):
        base = poses[row, :3] - [0, 0, 1.02]  # in base_link, as a camera node on a real arm says it
        pose = {"position": vector(base), "orientation": quaternion(poses[row, 3:])}
        content = {"header": header("/base_link"), "pose": pose}
        blind.add("/cylinder", "geometry_msgs/msg/PoseStamped", float(times[row]), content)
    topics = BagTopics(object_poses={"green_cylinder": "/cylinder"})
    grade = grade_bag(SCENARIO, blind.write(tmp_path / "camera.mcap"), topics)
    assert grade.earned == 14
    found = grade.run.signals.object_poses["green_cylinder"]
    rows = np.searchsorted(times, grade.run.signals.times - 1e-6)
    assert np.allclose(found, poses[rows], atol=2e-3)


def test_frames_alone_give_the_joints_too(stored, tmp_path):
    write_bag(tmp_path / "bag", stored)
    other = BagTopics(joint_states="/missing")
    grade = grade_bag(SCENARIO, tmp_path / "bag", other)
    assert grade.notes[0] == "there are no joint states; the joints are read from /tf"
    rows = np.searchsorted(stored.run.signals.times, grade.run.signals.times - 1e-6)
    assert np.allclose(
        grade.run.signals.joint_positions, stored.run.signals.joint_positions[rows], atol=1e-6
    )
    assert status_of(grade, "within limits") == "not observable"
    assert status_of(grade, "named target") == "passed"


def test_a_recording_of_another_arm_is_reported(recording, tmp_path):
    pose = [0, 0, 0.5, 1, 0, 0, 0]
    content = {"transforms": [transform("upper_arm_link", "forearm_link", pose)]}
    recording.add("/tf", "tf2_msgs/msg/TFMessage", 0.0, content)
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "other.mcap"), GAZEBO)
    assert any("is it the same robot, on the same base?" in note for note in grade.notes)


def test_frames_that_go_in_a_circle_are_reported_and_end(recording, tmp_path):
    circle = [transform("a", "green_cylinder", [0, 0, 0, 1, 0, 0, 0]),
              transform("green_cylinder", "a", [0, 0, 0, 1, 0, 0, 0])]  # fmt: skip
    blind = recording.without(POSES)
    blind.add("/tf", "tf2_msgs/msg/TFMessage", 0.0, {"transforms": circle})
    grade = grade_bag(SCENARIO, blind.write(tmp_path / "circle.mcap"))
    assert any("form a cycle" in note for note in grade.notes)
    assert status_of(grade, "displaced") in ("not observable", "not reached")


@pytest.mark.nightly
def test_two_programs_that_publish_the_same_joints_are_noticed(recording, stored, tmp_path):
    columns = {joint.name: index for index, joint in enumerate(stored.run.robot.movable_joints)}
    arm = {name: columns[name] for name in stored.run.robot.arm_joints}
    content = joint_state(stored.run.signals, 0, arm)
    for time in np.arange(4.01, 4.6, 0.02):
        recording.add("/joint_states", "sensor_msgs/msg/JointState", float(time), content)
    bag = recording.write(tmp_path / "twice.mcap")
    grade = grade_bag(SCENARIO, bag, GAZEBO)
    assert any("two programs publish it" in note for note in grade.notes)
    assert grade.earned == 0
    assert grade_bag(SCENARIO, bag, GAZEBO, allowed=["publishers"]).withheld == 0


@pytest.mark.nightly
def test_an_object_with_two_senders_costs_what_names_it(recording, tmp_path):
    still = transform("", "green_cylinder", [0.3, 0.3, 1.2, 1, 0, 0, 0])
    for time in np.arange(4.01, 8, 0.02):
        recording.add(POSES, "tf2_msgs/msg/TFMessage", float(time), {"transforms": [still]})
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "ghost.mcap"), GAZEBO)
    withheld = [row for row in grade.rows if row.withheld]
    assert withheld
    assert all("green_cylinder" in row.verdict.expectation for row in withheld)
    assert 0 < grade.earned < grade.points


@pytest.mark.nightly(but=["0.02-False"])
@pytest.mark.parametrize(("late", "is_doubted"), [(0.5, True), (0.02, False)])
def test_frames_that_contradict_the_joint_states_are_noticed(
    recording, stored, tmp_path, late, is_doubted
):
    """A frame of a joint as it was half a second ago is no frame of now; 20 ms ago it may be."""
    run = stored.run
    joint = run.robot.joint_by_name["shoulder_pan_joint"]
    poses = replayed_link_poses(run.robot, run.signals.joint_positions, {joint.parent, joint.child})
    parent, child = (
        np.broadcast_to(poses[name], (len(run.signals.times), 7))
        for name in (joint.parent, joint.child)
    )
    edges = relative(parent, child)
    for time in np.arange(1.0, run.signals.times[-1], 0.02):
        row = int(np.searchsorted(run.signals.times, time - late))
        content = {"transforms": [transform(joint.parent, joint.child, edges[row])]}
        recording.add("/tf", "tf2_msgs/msg/TFMessage", float(time), content)
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "late.mcap"), GAZEBO)
    assert any("contradict each other" in note for note in grade.notes) == is_doubted
    assert (grade.earned == grade.points) != is_doubted


@pytest.mark.nightly
def test_a_frame_without_a_parent_costs_what_is_in_it(recording, tmp_path):
    for message in recording.of(POSES):
        for each in message.content["transforms"]:
            if each["child_frame_id"] == "green_cylinder":
                each["header"]["frame_id"] = "my_map"
    bag = recording.write(tmp_path / "map.mcap")
    grade = grade_bag(SCENARIO, bag, GAZEBO)
    assert "frame 'my_map' has no parent; it counts as the world" in grade.notes
    withheld = {row.verdict.expectation for row in grade.rows if row.withheld}
    assert withheld
    assert all("green_cylinder" in each for each in withheld)
    assert grade_bag(SCENARIO, bag, GAZEBO, allowed=["frames"]).earned == 14


@pytest.mark.nightly
def test_limits_are_not_observable_where_a_joint_is_not_recorded(recording, tmp_path):
    """What a follower needs no sensor for, a joint of its own does."""
    for message in recording.of("/joint_states"):
        message.content = {**message.content, "effort": []}
    file = tmp_path / "limits.scenario.yaml"
    text = SCENARIO.read_text()
    head = text[: text.index("\nexpect:\n")]
    file.write_text(head + "\nexpect:\n  - within_limits: {}\n  - within_limits: {effort: false}\n")
    rows = grade_bag(file, recording.write(tmp_path / "student.mcap"), GAZEBO).rows[1:]
    lost, kept = (row.verdict for row in rows)
    assert (lost.status, lost.reason) == (
        "not observable", "the efforts of the joints were not recorded",
    )  # fmt: skip
    assert kept.status == "passed"
    for message in recording.of("/joint_states"):
        names = message.content["name"]
        kept = [place for place, name in enumerate(names) if name != "elbow_joint"]
        for key in ("name", "position", "velocity"):
            message.content[key] = [message.content[key][place] for place in kept]
    rows = grade_bag(file, recording.write(tmp_path / "one_less.mcap"), GAZEBO).rows[1:]
    lost = rows[1].verdict
    assert (lost.status, lost.reason) == (
        "not observable", "the position of elbow_joint was not recorded",
    )  # fmt: skip


def at(poses, row):
    return poses[row if len(poses) > 1 else 0]
