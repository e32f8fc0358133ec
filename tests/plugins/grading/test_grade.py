"""Verdicts and points of recordings, and of the bags that the harness writes."""

import json
import re
from dataclasses import fields

import pytest

from harness.cli.main import main
from harness.core.pose_arrays import relative
from harness.core.resources import data_folder
from harness.plugins.grading.grade import grade_bag
from harness.plugins.grading.points import graded
from harness.plugins.ros.bag.write import BagOptions, write_bag
from harness.recording.link_poses import replayed_link_poses
from harness.recording.read_run import read_run
from harness.recording.signals import Signals
from harness.recording.verdict import Verdict
from tests.plugins.grading.recordings import (
    GAZEBO,
    NEEDS_CONTACTS,
    POSES,
    SCENARIO,
    Recording,
    joint_state,
    status_of,
    transform,
)
from tests.plugins.grading.test_recorded_frames import at
from tests.running import run_case


@pytest.mark.nightly(but=["mcap"])
@pytest.mark.parametrize("kind", ["mcap", "sqlite3"])
def test_a_bag_of_the_harness_gets_the_verdicts_of_its_run_wherever_they_can_be_seen(
    stored, tmp_path, kind
):
    write_bag(tmp_path / "bag", stored, BagOptions(storage=kind))
    grade = grade_bag(SCENARIO, tmp_path / "bag")
    [note] = grade.notes
    assert note.startswith("the recorded program chose when these steps began: start, pick")
    assert len(grade.rows) == len(stored.verdicts)
    for row, judged in zip(grade.rows, stored.verdicts, strict=True):
        seen = row.verdict
        assert seen.expectation == judged.expectation
        if NEEDS_CONTACTS in judged.expectation:
            assert (seen.status, seen.reason) == ("not observable", "contacts were not recorded")
            continue
        assert seen.status == judged.status == "passed", seen
        assert seen.margin == pytest.approx(judged.margin, rel=0.05, abs=0.002), seen
    assert grade.earned == grade.points == 14


@pytest.mark.nightly
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
        if NEEDS_CONTACTS not in judged.expectation:
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


def test_a_graded_recording_has_the_page_of_a_run(recording, tmp_path, capsys):
    bag = recording.write(tmp_path / "student.mcap")
    words = ("grade", str(SCENARIO), str(bag), "--objects", POSES)
    assert main([*words, "--report-dir", str(tmp_path / "reports")]) == 0
    [page] = (tmp_path / "reports").rglob("report.html")
    assert page.parent.name == "student"
    assert f"report: {page.parent}" in capsys.readouterr().out
    kept = read_run(page.parent)
    assert (kept.outcome, kept.run.file, kept.changes()) == ("passed", str(bag), [])
    assert [each.credit for each in kept.verdicts if each.credit][-1] == "1 of 1 points"
    assert "points <b>14 of 14</b>" in page.read_text(), "in the summary"
    assert kept.run.source == SCENARIO.read_text(), "whose lines the verdicts name"
    assert main(["judge", str(page.parent)]) in (0, 1)
    assert main([*words, "--report-dir", str(tmp_path / "none"), "--no-report"]) == 0
    assert not (tmp_path / "none").exists()


@pytest.mark.nightly
def test_what_is_worth_nothing_does_not_lower_a_full_grade(recording, tmp_path, capsys):
    bag = recording.write(tmp_path / "student.mcap")
    assert main(["grade", str(SCENARIO), str(bag), "--objects", POSES]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("? no points  line 15: grasped green_cylinder: not observable")
    assert said[-1] == "14 of 14 points"


def test_a_cylinder_that_was_not_moved_costs_its_points_with_a_reason(recording, tmp_path, capsys):
    for message in recording.of(POSES):
        message.content = recording.of(POSES)[0].content
    bag = recording.write(tmp_path / "lazy.mcap")
    words = ["grade", str(SCENARIO), str(bag), "--objects", POSES]
    assert main(words) == 1
    said = capsys.readouterr().out
    assert "green_cylinder is 0 mm from its start" in said
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


@pytest.mark.nightly
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


EACH = {
    "named_target": "{state: mogi_home}",
    "joints": "{positions: {elbow_joint: 0}}",
    "gripper": "{named_target: open}",
    "tcp_pose": "{pose: {xyz: [0, 0, 1]}, tolerance: {position: 99 cm}, position_only: true}",
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


@pytest.mark.nightly
def test_the_page_says_what_a_recording_can_show(recording, tmp_path):
    """Every kind in the page's table is judged, or not, as its row says."""
    page = (data_folder("scenarios").parent / "docs/guides/grading.md").read_text()
    rows = re.findall(r"(?m)^\| (?:needs )?([^|]+?) \| (.*) \|$", page)
    said = {what: set(re.findall(r"`([a-z_]+)`", kinds)) & set(EACH) for what, kinds in rows}
    seen = said["joints"] | said["poses of objects"]
    unseen = (
        said["commands"]
        | said["what the planner attached, and results of steps"]
        | said["contacts"]
    ) - seen
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


def test_what_a_recording_lacks_is_named_as_a_run_has_it(recording, tmp_path):
    run = grade_bag(SCENARIO, recording.write(tmp_path / "student.mcap"), GAZEBO).run
    known = {entry.name for entry in fields(Signals)} | {"attachments", "steps", "step_results"}
    assert {"contact_forces", "presses", "support_forces"} <= set(run.unrecorded) <= known


def test_points_add_up_and_count_one_each_where_none_are_given():
    def verdict(status, points=None):
        return Verdict("x", status, points=points)

    given = graded([verdict("passed", 2.5), verdict("failed", 1), verdict("passed")])
    assert [(row.points, row.earned) for row in given] == [(2.5, 2.5), (1, 0), (0, 0)]
    plain = graded([verdict("passed"), verdict("not reached"), verdict("not observable")])
    assert [(row.points, row.earned) for row in plain] == [(1, 1), (1, 0), (1, 0)]


LESSONS = sorted((data_folder("scenarios") / "lessons").glob("*.scenario.yaml"))


@pytest.mark.nightly
@pytest.mark.parametrize("lesson", LESSONS, ids=lambda path: path.name.partition(".")[0])
def test_a_lesson_loses_no_point_when_its_own_bag_is_graded(lesson, recorded_run, tmp_path):
    """What the bag shows is judged as in the run; contacts alone cannot be seen in it."""
    stored = read_run(recorded_run(lesson) / "run")
    for kind in ("mcap", "sqlite3"):
        write_bag(tmp_path / kind, stored, BagOptions(storage=kind))
        rows = grade_bag(lesson, tmp_path / kind).rows
        judged = [(row.verdict.expectation, row.verdict.status) for row in rows]
        expected = [(verdict.expectation, verdict.status) for verdict in stored.verdicts]
        for (name, status), (run_name, run_status) in zip(judged, expected, strict=True):
            assert name == run_name
            assert status in (run_status, "not observable"), name


GRIPPER_ALONE = data_folder("scenarios") / "lessons/04_gripper_alone.scenario.yaml"


@pytest.mark.nightly
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


@pytest.fixture
def gripper_run(recorded_run):
    return read_run(recorded_run(GRIPPER_ALONE) / "run").run


def test_a_gripper_alone_is_graded_from_joint_states_and_from_frames(gripper_run, tmp_path):
    """A recorder of the gripper's joint alone, and one of the frames of its links."""
    columns = {joint.name: i for i, joint in enumerate(gripper_run.robot.movable_joints)}
    hand = {gripper_run.robot.gripper.joint: columns[gripper_run.robot.gripper.joint]}
    times = gripper_run.signals.times
    poses = replayed_link_poses(gripper_run.robot, gripper_run.signals.joint_positions)
    joints, frames = Recording(), Recording()
    for row in range(0, len(times), 20):
        state = joint_state(gripper_run.signals, row, hand)
        joints.add("/joint_states", "sensor_msgs/msg/JointState", float(times[row]), state)
        moved = [
            transform(
                p.parent, p.child, relative(at(poses[p.parent], row), at(poses[p.child], row))
            )
            for p in gripper_run.robot.joints
        ]
        frames.add("/tf", "tf2_msgs/msg/TFMessage", float(times[row]), {"transforms": moved})
    file = tmp_path / "closed.scenario.yaml"
    head = GRIPPER_ALONE.read_text().partition("\nexpect:")[0]
    file.write_text(f"{head}\nexpect:\n  - eventually: {{gripper: {{named_target: closed}}}}\n")
    for recording in (joints, frames):
        grade = grade_bag(file, recording.write(tmp_path / "hand.mcap"))
        assert grade.rows[-1].verdict.status == "passed"
        assert {row.verdict.status for row in grade.rows[:-1]} == {"not observable"}
