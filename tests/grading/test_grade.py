"""Recordings of other programs, graded; broken ones, refused."""

import json
import random
import re
import shutil
import sqlite3
import struct
from dataclasses import fields, replace

import numpy as np
import pytest
import zstandard
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.core.pose_arrays import relative
from harness.core.resources import data_folder
from harness.grading.bag import reader, storage
from harness.grading.bag.content import BagTopics
from harness.grading.grade import grade_bag, graded
from harness.recording.link_poses import replayed_link_poses
from harness.recording.read_run import read_run
from harness.recording.signals import Signals
from harness.recording.verdict import Verdict
from harness.reporting.rosbag.write import BagOptions, write_bag
from tests.grading.recordings import (
    GAZEBO_STARTED,
    POSES,
    STORE,
    WALL_CLOCK,
    Recording,
    header,
    joint_state,
    quaternion,
    students_recording,
    transform,
    vector,
)
from tests.running import run_case

SCENARIO = data_folder("scenarios") / "grading/pick_and_place.scenario.yaml"
GAZEBO = BagTopics(objects=(POSES,))
NEEDS_CONTACTS = ("grasped",)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The scenario's own run."""
    folder = tmp_path_factory.mktemp("graded") / "run"
    result = run_case(SCENARIO, report_dir=folder, stills=False, page=False)
    assert result.outcome == "passed", result.message
    return folder


@pytest.fixture(scope="module")
def stored(folder):
    return read_run(folder)


@pytest.fixture
def recording(stored):
    return students_recording(stored.run)


def statuses(grade):
    return {row.verdict.expectation: row.verdict.status for row in grade.rows}


def status_of(grade, word):
    [status] = [value for key, value in statuses(grade).items() if word in key]
    return status


@pytest.mark.parametrize("kind", ["mcap", "sqlite3"])
def test_a_bag_of_the_harness_gets_the_verdicts_of_its_run_wherever_they_can_be_seen(
    stored, tmp_path, kind
):
    write_bag(tmp_path / "bag", stored, BagOptions(storage=kind))
    grade = grade_bag(SCENARIO, tmp_path / "bag")
    assert grade.notes == ()
    assert len(grade.rows) == len(stored.verdicts)
    for row, judged in zip(grade.rows, stored.verdicts, strict=True):
        seen = row.verdict
        assert seen.expectation == judged.expectation
        if judged.expectation.startswith(NEEDS_CONTACTS):
            assert (seen.status, seen.reason) == ("not observable", "contacts were not recorded")
            continue
        assert seen.status == judged.status == "passed", seen
        assert seen.margin == pytest.approx(judged.margin, rel=0.05, abs=0.002), seen
    assert grade.earned == grade.points == 14


def test_a_run_that_fails_fails_as_a_bag_too(tmp_path):
    """Put down elsewhere: the other side of the round trip."""
    wrong = {"steps.3.place.pose.xyz": "[0.3, 0.05, 0.045]"}
    result = run_case(
        SCENARIO, overrides=wrong, report_dir=tmp_path / "r", stills=False, page=False
    )
    assert result.outcome == "failed", result.message
    write_bag(tmp_path / "bag", read_run(tmp_path / "r"))
    grade = grade_bag(SCENARIO, tmp_path / "bag")
    for row, judged in zip(grade.rows, result.verdicts, strict=True):
        if not judged.expectation.startswith(NEEDS_CONTACTS):
            assert row.verdict.status == judged.status, row
    [lost] = [row for row in grade.rows if row.earned < row.points]
    assert "abs(x(green_cylinder) - 0.3) < 1 cm" in lost.verdict.expectation
    assert (lost.points, grade.earned) == (2, 12)


def test_a_students_recording_earns_what_it_shows(recording, tmp_path):
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "student.mcap"), GAZEBO)
    assert grade.earned == grade.points == 14
    assert status_of(grade, "grasped") == "not observable"
    reason = next(r.verdict.reason for r in grade.rows if "grasped" in r.verdict.expectation)
    assert reason == "when step 'pick' ran was not recorded"
    assert grade.notes == ()


def test_what_is_worth_nothing_does_not_lower_a_full_grade(recording, tmp_path, capsys):
    bag = recording.write(tmp_path / "student.mcap")
    assert main(["grade", str(SCENARIO), str(bag), "--objects", POSES]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("?       ?/0  line 15: grasped green_cylinder: not observable")
    assert said[-1] == "14 of 14 points"


def test_joints_that_follow_another_are_where_that_one_puts_them(recording, stored, tmp_path):
    run = grade_bag(SCENARIO, recording.write(tmp_path / "student.mcap"), GAZEBO).run
    followers = [n for n, joint in enumerate(run.robot.joints) if joint.is_mimic]
    rows = np.searchsorted(stored.run.signals.times, run.signals.times - 1e-6)
    assert len(followers) == 3
    assert np.allclose(
        run.signals.joint_positions[:, followers],
        stored.run.signals.joint_positions[rows][:, followers],
        atol=0.05,
    )
    assert np.allclose(run.signals.tcp_pose, stored.run.signals.tcp_pose[rows], atol=1e-6)


def test_a_cylinder_that_was_not_moved_costs_its_points_with_a_reason(recording, tmp_path, capsys):
    for message in recording.of(POSES):
        message.content = recording.of(POSES)[0].content
    bag = recording.write(tmp_path / "lazy.mcap")
    words = ["grade", str(SCENARIO), str(bag), "--objects", POSES]
    assert main(words) == 1
    said = capsys.readouterr().out
    assert "green_cylinder is 0.0 mm from its start" in said
    assert said.splitlines()[-1] == "8 of 14 points"
    assert main([*words, "--json"]) == 1
    reported = json.loads(capsys.readouterr().out)
    assert (reported["earned"], reported["points"], reported["not_observable"]) == (8, 14, 0)
    lost = [
        row["verdict"]["expectation"] for row in reported["rows"] if row["earned"] < row["points"]
    ]
    assert len(lost) == 3


def test_without_poses_of_objects_only_the_robot_is_judged(recording, tmp_path, capsys):
    bag = recording.without(POSES).write(tmp_path / "blind.mcap")
    assert main(["grade", str(SCENARIO), str(bag)]) == 1
    said = capsys.readouterr().out
    assert "the recording lacks poses of red_box, green_cylinder" in said
    assert "not observable: where 'green_cylinder' stood was not recorded" in said
    assert said.splitlines()[-1] == "4 of 14 points; 10 of them cannot be seen in this recording"


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


def test_messages_in_disorder_and_twice_change_nothing(recording, tmp_path):
    straight = grade_bag(SCENARIO, recording.write(tmp_path / "straight.mcap"), GAZEBO)
    shuffled = list(recording.messages)
    source = random.Random(3)
    for start in range(0, len(shuffled), 12):
        block = shuffled[start : start + 12]
        source.shuffle(block)
        shuffled[start : start + 12] = block
    for message in shuffled:
        message.logged += source.uniform(0, 0.05)
    recording.messages = shuffled + shuffled[100:160]
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "disorder.mcap"), GAZEBO)
    assert [row.verdict for row in grade.rows] == [row.verdict for row in straight.rows]


def test_objects_stamped_by_another_clock_come_over_the_recorders(recording, tmp_path):
    """The tracker has no `use_sim_time`; simulation ran at half speed."""
    for message in recording.of(POSES):
        message.stamp = message.logged
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "clocks.mcap"), GAZEBO)
    assert grade.earned == 14
    [note] = grade.notes
    assert "and the joint states have different clocks" in note


def test_joint_states_without_stamps_are_where_the_recorder_got_them(recording, tmp_path):
    for message in recording.messages:
        message.stamp, message.logged = 0.0, WALL_CLOCK + (message.stamp - GAZEBO_STARTED)
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "no_stamps.mcap"), GAZEBO)
    assert grade.earned == 14
    assert any("have no stamps" in note for note in grade.notes)


def test_after_a_simulation_was_restarted_only_the_last_attempt_counts(recording, tmp_path):
    """Both attempts have the same stamps: sorting them together would make a third."""
    first = [replace(message) for message in recording.messages]
    for message in first:
        message.logged -= 100.0
        if message.topic == POSES:
            message.content = {"transforms": []}
    recording.messages = first + recording.messages
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "twice.mcap"), GAZEBO)
    assert grade.earned == 14
    assert any("the clock was set back" in note for note in grade.notes)


def test_frames_alone_give_the_joints_too(stored, tmp_path):
    write_bag(tmp_path / "bag", stored)
    other = BagTopics(joint_states="/missing")
    grade = grade_bag(SCENARIO, tmp_path / "bag", other)
    assert grade.notes[0] == "there are no joint states; the joints are read from /tf"
    rows = np.searchsorted(stored.run.signals.times, grade.run.signals.times - 1e-6)
    assert np.allclose(
        grade.run.signals.joint_positions, stored.run.signals.joint_positions[rows], atol=1e-6
    )
    assert status_of(grade, "within_limits") == "not observable"
    assert status_of(grade, "named_target") == "passed"


def test_a_gap_is_no_failure_and_no_success(recording, tmp_path):
    gone = (GAZEBO_STARTED + 4, GAZEBO_STARTED + 8)
    recording.messages = [
        m for m in recording.messages if m.topic != POSES or not gone[0] < m.stamp < gone[1]
    ]
    file = tmp_path / "always.scenario.yaml"
    text = SCENARIO.read_text()
    file.write_text(text[: text.index("expect:\n  - eventually")] + (
        "expect:\n  - always: {upright: green_cylinder}\n  - always: {upright: red_box}\n"
        "  - upright: green_cylinder\n"
    ))  # fmt: skip
    bag = recording.write(tmp_path / "gap.mcap")
    grade = grade_bag(file, bag, GAZEBO)
    [_, held, _, bare] = [row.verdict for row in grade.rows]
    assert held.status == "not observable"
    assert held.reason.endswith("are not known, and would decide it")
    assert bare.status == "passed"
    assert any("green_cylinder: no pose for" in note for note in grade.notes)


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


def test_a_student_can_record_when_steps_began(recording, tmp_path):
    for time, step in ((4.0, "pick"), (10.1, "hold")):
        content = {"data": json.dumps({"event": "step_started", "step": step})}
        recording.add("/armharness/events", "std_msgs/msg/String", time, content)
    run = grade_bag(SCENARIO, recording.write(tmp_path / "reported.mcap"), GAZEBO).run
    assert [step.id for step in run.steps] == ["pick", "hold"]
    assert run.steps[0].start_time == pytest.approx(4.0, abs=0.05)
    assert run.steps[0].end_time == pytest.approx(10.1, abs=0.05)
    assert run.steps[0].line > 1


def test_points_for_steps_that_the_student_chose_are_withheld(recording, tmp_path, capsys):
    for time, step in ((4.0, "hold"), (10.1, "place")):
        content = {"data": json.dumps({"event": "step_started", "step": step})}
        recording.add("/armharness/events", "std_msgs/msg/String", time, content)
    bag = recording.write(tmp_path / "chosen.mcap")
    file = tmp_path / "chosen.scenario.yaml"
    text = SCENARIO.read_text()
    file.write_text(text[: text.index("expect:\n  - eventually")] + (
        "expect:\n  - {eventually: {upright: green_cylinder}, during: hold, points: 2}\n"
        "  - {upright: green_cylinder, points: 3}\n"
    ))  # fmt: skip
    [*_, chosen, whole] = grade_bag(file, bag, GAZEBO).rows
    assert (chosen.verdict.status, chosen.earned, chosen.withheld) == ("passed", 0, ("steps",))
    assert (whole.earned, whole.withheld) == (3, ())
    [*_, chosen, _] = grade_bag(file, bag, GAZEBO, allowed=["steps"]).rows
    assert (chosen.earned, chosen.withheld) == (2, ())
    words = ["grade", str(file), str(bag), "--objects", POSES]
    main(words)
    said = capsys.readouterr().out
    assert "0*/2" in said
    assert "2 of them are withheld: --allow steps" in said
    main([*words, "--allow", "steps"])
    assert "withheld" not in capsys.readouterr().out


@pytest.mark.parametrize("seconds", [(4.0, 6.0), (4.0, 4.4), (9.0, 9.3)])
def test_nothing_is_interpolated_across_a_hole_in_the_joint_states(recording, tmp_path, seconds):
    begin, end = (GAZEBO_STARTED + second for second in seconds)
    recording.messages = [
        m for m in recording.messages if m.topic != "/joint_states" or not begin < m.stamp < end
    ]
    file = tmp_path / "hole.scenario.yaml"
    text = SCENARIO.read_text()
    file.write_text(text[: text.index("expect:\n  - eventually")] + (
        "expect:\n  - formula: always z(tcp) > 0\n"
        "  - formula: always z(green_cylinder) > 0\n  - upright: green_cylinder\n"
    ))  # fmt: skip
    grade = grade_bag(file, recording.write(tmp_path / "hole.mcap"), GAZEBO)
    [_, arm, cylinder, _] = [row.verdict for row in grade.rows]
    assert arm.status == "not observable"
    assert cylinder.status == "passed"
    run = grade.run
    inside = (run.signals.times > seconds[0] + 0.05) & (run.signals.times < seconds[1] - 0.05)
    assert inside.sum() > 5
    assert np.isnan(run.signals.tcp_pose[inside]).all()
    assert not np.isnan(run.signals.object_poses["green_cylinder"][inside]).any()


def test_a_few_lost_messages_are_no_hole(recording, tmp_path):
    lost = (GAZEBO_STARTED + 4.0, GAZEBO_STARTED + 4.09)
    recording.messages = [m for m in recording.messages if not lost[0] < m.stamp < lost[1]]
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "lost.mcap"), GAZEBO)
    assert grade.notes == ()
    assert grade.earned == grade.points


def test_a_clock_that_jumps_ahead_leaves_an_hour_unknown(recording, tmp_path):
    for message in recording.messages:
        if message.stamp > GAZEBO_STARTED + 5:
            message.stamp += 3600
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "jump.mcap"), GAZEBO)
    assert any("has a gap that begins at t=5." in note for note in grade.notes)
    assert status_of(grade, "within_limits") == "not observable"
    assert status_of(grade, "named_target") == "passed"


def test_two_programs_that_publish_the_same_joints_are_noticed(recording, stored, tmp_path):
    columns = {joint.name: index for index, joint in enumerate(stored.run.robot.joints)}
    arm = {name: columns[name] for name in stored.run.robot.arm_joints}
    content = joint_state(stored.run.signals, 0, arm)
    for time in np.arange(4.01, 4.6, 0.02):
        recording.add("/joint_states", "sensor_msgs/msg/JointState", float(time), content)
    bag = recording.write(tmp_path / "twice.mcap")
    grade = grade_bag(SCENARIO, bag, GAZEBO)
    assert any("two programs publish it" in note for note in grade.notes)
    assert grade.earned == 0
    assert grade_bag(SCENARIO, bag, GAZEBO, allowed=["publishers"]).withheld == 0


def test_an_object_with_two_senders_costs_what_names_it(recording, tmp_path):
    still = transform("", "green_cylinder", [0.3, 0.3, 1.2, 1, 0, 0, 0])
    for time in np.arange(4.01, 8, 0.02):
        recording.add(POSES, "tf2_msgs/msg/TFMessage", float(time), {"transforms": [still]})
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "ghost.mcap"), GAZEBO)
    withheld = [row for row in grade.rows if row.withheld]
    assert withheld
    assert all("green_cylinder" in row.verdict.expectation for row in withheld)
    assert 0 < grade.earned < grade.points


@pytest.mark.parametrize(("late", "is_doubted"), [(0.5, True), (0.02, False)])
def test_frames_that_contradict_the_joint_states_are_noticed(
    recording, stored, tmp_path, late, is_doubted
):
    """A frame of a joint as it was half a second ago is no frame of now; 20 ms ago it may be."""
    run = stored.run
    (placement,) = [each for each in run.robot.placements if each.joint == "shoulder_pan_joint"]
    poses = replayed_link_poses(
        run.robot, run.signals.joint_positions, {placement.parent, placement.link}
    )
    parent, child = (
        np.broadcast_to(poses[name], (len(run.signals.times), 7))
        for name in (placement.parent, placement.link)
    )
    edges = relative(parent, child)
    for time in np.arange(1.0, run.signals.times[-1], 0.02):
        row = int(np.searchsorted(run.signals.times, time - late))
        content = {"transforms": [transform(placement.parent, placement.link, edges[row])]}
        recording.add("/tf", "tf2_msgs/msg/TFMessage", float(time), content)
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "late.mcap"), GAZEBO)
    assert any("contradict each other" in note for note in grade.notes) == is_doubted
    assert (grade.earned == grade.points) != is_doubted


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


@pytest.mark.parametrize("compression", list(CompressionType))
def test_chunks_may_be_compressed_in_any_way(recording, tmp_path, compression):
    path = recording.write(tmp_path / "packed.mcap", compression, chunk_size=20_000)
    assert reader.read_bag(path, GAZEBO).topics[POSES][1] == len(recording.of(POSES))


def test_qos_in_any_dialect_is_no_reason_to_refuse(recording, tmp_path):
    """Version 9 with words, as Kilted writes it, and then an unreadable version."""
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        kinds = {m.topic: m.msgtype for m in recording.messages}
        topics = {
            topic: writer.add_connection(topic, kind, typestore=STORE)
            for topic, kind in kinds.items()
        }
        whole = recording.write(tmp_path / "whole.mcap")
        for raw in storage.messages(storage.bag_files(whole)):
            writer.write(topics[raw.topic], raw.log_time, raw.data)
    assert grade_bag(SCENARIO, tmp_path / "bag", GAZEBO).earned == 14
    database = sqlite3.connect(tmp_path / "bag/bag.db3")
    database.execute("UPDATE topics SET offered_qos_profiles = ': [ not yaml'")
    database.commit()
    database.close()
    assert grade_bag(SCENARIO, tmp_path / "bag", GAZEBO).earned == 14
    (tmp_path / "bag/metadata.yaml").unlink()
    grade = grade_bag(SCENARIO, tmp_path / "bag", GAZEBO)
    assert grade.earned == 14
    assert "metadata.yaml is missing, as after a recorder was killed" in grade.notes[0]


EACH = {
    "named_target": "{state: mogi_home}",
    "joints": "{positions: {elbow_joint: 0}}",
    "gripper": "{named_target: open}",
    "tcp_pose": "{pose: {xyz: [0, 0, 1]}, tolerance: {position: 1 m}, position_only: true}",
    "tcp_path": "{line: {start: {xyz: [0, 0, 1]}, end: {xyz: [1, 0, 1]}}}",
    "path_length": "{at_most: 10 m}",
    "duration": "{at_most: 60 s}",
    "within_limits": "{}",
    "effort": "{}",
    "tracking_error": "{}",
    "displaced": "{object: red_box}",
    "upright": "{object: red_box}",
    "static": "{object: red_box}",
    "in": "{object: red_box, container: Table}",
    "clearance": "{between: [robot, Table], at_least: 0}",
    "slip": "{object: green_cylinder}",
    "lifted": "{object: green_cylinder}",
    "grasped": "{object: green_cylinder}",
    "released": "{object: green_cylinder}",
    "placed": "{object: green_cylinder}",
    "on": "{object: red_box, support: Table}",
    "in_contact": "{between: [robot, Table]}",
    "collision": "{}",
}
"""One expectation of each kind."""


def test_the_page_says_what_a_recording_can_show(recording, tmp_path):
    """Every kind in the page's table is judged, or not, as its row says."""
    page = (data_folder("scenarios").parent / "docs/guides/grading.md").read_text()
    rows = re.findall(r"(?m)^\| (?:needs )?([^|]+?) \| (.*) \|$", page)
    said = {what: set(re.findall(r"`([a-z_]+)`", kinds)) & set(EACH) for what, kinds in rows}
    seen = said["joints"] | said["poses of objects"]
    unseen = (said["commands"] | said["events of a harness run"] | said["contacts"]) - seen
    assert seen | unseen == set(EACH)
    file = tmp_path / "each.scenario.yaml"
    text = SCENARIO.read_text()
    head = text[: text.index("\nexpect:\n")]
    file.write_text(head + "\nexpect:\n" + "".join(f"  - {k}: {v}\n" for k, v in EACH.items()))
    grade = grade_bag(file, recording.write(tmp_path / "student.mcap"), GAZEBO)
    verdicts = dict(zip(EACH, (row.verdict for row in grade.rows[1:]), strict=True))
    for kind, verdict in verdicts.items():
        assert (verdict.status == "not observable") == (kind in unseen), (kind, verdict)
        assert verdict.status != "not reached", (kind, verdict)
    assert verdicts["within_limits"].status == verdicts["effort"].status == "passed"


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


def test_what_a_recording_lacks_is_named_as_a_run_has_it(recording, tmp_path):
    run = grade_bag(SCENARIO, recording.write(tmp_path / "student.mcap"), GAZEBO).run
    known = {entry.name for entry in fields(Signals)} | {"attachments", "steps"}
    assert {"contact_forces", "presses", "support_forces"} <= set(run.unrecorded) <= known


def test_points_add_up_and_count_one_each_where_none_are_given():
    def verdict(status, points=None):
        return Verdict("x", status, points=points)

    given = graded([verdict("passed", 2.5), verdict("failed", 1), verdict("passed")])
    assert [(row.points, row.earned) for row in given] == [(2.5, 2.5), (1, 0), (0, 0)]
    plain = graded([verdict("passed"), verdict("not reached"), verdict("not observable")])
    assert [(row.points, row.earned) for row in plain] == [(1, 1), (1, 0), (1, 0)]


def empty(path, _):
    (path / "bag.mcap").write_bytes(b"")
    return path / "bag.mcap", "is empty"


def cut_off(path, whole):
    data = whole.read_bytes()
    (path / "bag.mcap").write_bytes(data[: len(data) * 2 // 3])
    return path / "bag.mcap", "is cut off after"


def no_mcap(path, _):
    (path / "bag.mcap").write_text("joint states of Monday\n" * 20)
    return path / "bag.mcap", "not an MCAP file"


def one_byte_changed(path, whole):
    data = bytearray(whole.read_bytes())
    data[len(data) // 2] ^= 0xFF
    (path / "bag.mcap").write_bytes(data)
    return path / "bag.mcap", "near byte"


def a_length_of_exabytes(path, whole):
    data = bytearray(whole.read_bytes())
    data[9:17] = struct.pack("<Q", 2**62)
    (path / "bag.mcap").write_bytes(data)
    return path / "bag.mcap", "exceeds limit"


def bomb(path, _):
    """A chunk of a hundred kilobytes that unpacks to gigabytes and says it were small."""
    packed = zstandard.ZstdCompressor(level=3, write_content_size=False)
    unpacked = packed.compressobj()
    data = b"".join(unpacked.compress(bytes(2**20)) for _ in range(600)) + unpacked.flush()
    body = struct.pack("<QQQI", 0, 0, 1000, 0) + struct.pack("<I", 4) + b"zstd"
    body += struct.pack("<Q", len(data)) + data
    record = b"\x06" + struct.pack("<Q", len(body)) + body
    with (path / "bag.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros2")
        file.flush()
    start = (path / "bag.mcap").read_bytes()
    (path / "bag.mcap").write_bytes(start + record)
    return path / "bag.mcap", "unpacks to more than the maximum of 1000 bytes"


def nothing(path, _):
    return path / "nowhere", "there is no such recording"


def an_empty_folder(path, _):
    (path / "bag").mkdir()
    return path / "bag", "is not a recording: it has no metadata.yaml, no .mcap and no .db3 file"


def another_file(path, _):
    (path / "notes.txt").write_text("x")
    return path / "notes.txt", "is not a recording"


def broken_metadata(path, _):
    (path / "bag").mkdir()
    (path / "bag/metadata.yaml").write_text("rosbag2_bagfile_information:\n  version: [8\nx: }")
    return path / "bag", "metadata.yaml:3:"


def metadata_without_files(path, _):
    (path / "bag").mkdir()
    (path / "bag/metadata.yaml").write_text("- 1\n")
    return path / "bag", "does not list the recording's files"


def a_missing_file(path, whole):
    (path / "bag").mkdir()
    text = "rosbag2_bagfile_information: {relative_file_paths: [../../one.mcap]}"
    (path / "bag/metadata.yaml").write_text(text)
    shutil.copy(whole, path / "one.mcap")
    return path / "bag", "one.mcap: is missing, although metadata.yaml lists it"


def no_database(path, _):
    (path / "bag.db3").write_text("SQLite format 4\0" + "x" * 5000)
    return path / "bag.db3", "cannot be read as a database"


def another_database(path, _):
    database = sqlite3.connect(path / "bag.db3")
    database.execute("CREATE VIEW messages AS SELECT 1 AS topic_id")
    database.commit()
    database.close()
    return path / "bag.db3", "it lacks the tables `topics` and `messages`"


def without_messages(path, _):
    with (path / "bag.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros2")
        writer.finish()
    return path / "bag.mcap", "it has no messages"


BROKEN = (
    *(empty, cut_off, no_mcap, one_byte_changed, a_length_of_exabytes, bomb, nothing),
    *(an_empty_folder, another_file, broken_metadata, metadata_without_files, a_missing_file),
    *(no_database, another_database, without_messages),
)


@pytest.fixture(scope="module")
def whole(stored, tmp_path_factory):
    return students_recording(stored.run).write(tmp_path_factory.mktemp("whole") / "whole.mcap")


@pytest.mark.parametrize("breaks", BROKEN, ids=lambda breaks: breaks.__name__)
def test_a_recording_that_cannot_be_used_is_reported_by_its_name(breaks, whole, tmp_path, capsys):
    bag, said = breaks(tmp_path, whole)
    assert main(["grade", str(SCENARIO), str(bag)]) == 2
    reported = capsys.readouterr().err
    assert reported.startswith(str(bag)) or str(tmp_path) in reported.split(":")[0]
    assert said in reported
    assert "Traceback" not in reported


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--objects", "/nowhere"], f"has no topic /nowhere\n  topics with poses there: {POSES}"),
        (["--objects", "/joint_states"], "/joint_states is of type sensor_msgs/msg/JointState"),
        (["--object", "green_cylinder=" + POSES], "which has no poses of objects"),
        (["--object", "cylinder"], "'cylinder' is not NAME=TOPIC"),
        (
            ["--joint-states", "/arm/joints"],
            "topics of joint states: /joint_states (--joint-states",
        ),
        (["--set", "robot.model=open_manipulator_x"], ""),
    ],
)
def test_wrong_names_are_reported_with_the_right_ones(words, said, whole, capsys):
    try:
        code = main(["grade", str(SCENARIO), str(whole), *words])
    except SystemExit as error:
        code = error.code
    assert code == 2
    assert said in capsys.readouterr().err


def test_a_recording_larger_than_what_is_kept_is_refused_while_it_is_read(whole, monkeypatch):
    read = []

    def counted(files):
        for message in storage.messages(files):
            read.append(message.topic)
            yield message

    monkeypatch.setattr(reader, "MOST_NUMBERS", 5_000)
    monkeypatch.setattr(reader, "messages", counted)
    with pytest.raises(SpecError, match="holds more than 5000 numbers of joints and frames"):
        reader.read_bag(whole, GAZEBO)
    assert len(read) < 400


LESSONS = sorted((data_folder("scenarios") / "lessons").glob("*.scenario.yaml"))


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda path: path.name.partition(".")[0])
def test_a_lesson_loses_no_point_when_its_own_bag_is_graded(lesson, tmp_path):
    """What the bag shows is judged as in the run; contacts alone cannot be seen in it."""
    result = run_case(lesson, report_dir=tmp_path / "run", stills=False, page=False)
    stored = read_run(tmp_path / "run")
    for kind in ("mcap", "sqlite3"):
        write_bag(tmp_path / kind, stored, BagOptions(storage=kind))
        rows = grade_bag(lesson, tmp_path / kind).rows
        judged = [(row.verdict.expectation, row.verdict.status) for row in rows]
        expected = [(verdict.expectation, verdict.status) for verdict in result.verdicts]
        for (name, status), (run_name, run_status) in zip(judged, expected, strict=True):
            assert name == run_name
            assert status in (run_status, "not observable"), name


GRIPPER_ALONE = data_folder("scenarios") / "lessons/04_gripper_alone.scenario.yaml"


def test_a_bag_of_another_robot_is_refused_for_a_gripper_alone(recording, tmp_path, capsys):
    """The gripper's joints are in no message; the error names the joints that were expected."""
    recording.messages = [
        message
        for message in recording.messages
        if "rh_r1_joint" not in message.content.get("name", [])
    ]
    bag = recording.write(tmp_path / "arm.mcap")
    for message, words in (
        ("names none of the robot's joints, but elbow_joint", []),
        ("has no /joints and no frames of this robot", ["--joint-states", "/joints"]),
    ):
        assert main(["grade", str(GRIPPER_ALONE), str(bag), *words]) == 2
        said = capsys.readouterr().err
        assert said.startswith(str(bag))
        assert message in said


@pytest.fixture(scope="module")
def gripper_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gripper") / "run"
    assert run_case(GRIPPER_ALONE, report_dir=folder, stills=False, page=False).outcome == "passed"
    return read_run(folder).run


def test_a_gripper_alone_is_graded_from_joint_states_and_from_frames(gripper_run, tmp_path):
    """A recorder of the gripper's joint alone, and one of the frames of its links."""
    columns = {joint.name: i for i, joint in enumerate(gripper_run.robot.joints)}
    hand = {gripper_run.robot.gripper.joint: columns[gripper_run.robot.gripper.joint]}
    times = gripper_run.signals.times
    poses = replayed_link_poses(gripper_run.robot, gripper_run.signals.joint_positions)
    joints, frames = Recording(), Recording()
    for row in range(0, len(times), 20):
        state = joint_state(gripper_run.signals, row, hand)
        joints.add("/joint_states", "sensor_msgs/msg/JointState", float(times[row]), state)
        moved = [
            transform(p.parent, p.link, relative(at(poses[p.parent], row), at(poses[p.link], row)))
            for p in gripper_run.robot.placements
        ]
        frames.add("/tf", "tf2_msgs/msg/TFMessage", float(times[row]), {"transforms": moved})
    file = tmp_path / "closed.scenario.yaml"
    head = GRIPPER_ALONE.read_text().partition("\nexpect:")[0]
    file.write_text(f"{head}\nexpect:\n  - eventually: {{gripper: {{named_target: closed}}}}\n")
    for recording in (joints, frames):
        grade = grade_bag(file, recording.write(tmp_path / "hand.mcap"))
        assert grade.rows[-1].verdict.status == "passed"
        assert {row.verdict.status for row in grade.rows[:-1]} == {"not observable"}


def at(poses, row):
    return poses[row if len(poses) > 1 else 0]
