"""CSV files of joint values over time as recordings."""

import csv

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.grade import grade_bag
from harness.recording.read_run import read_run

JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]
JOINTS += ["wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
EXERCISE = """\
scenario: Turn the base by a radian
robot: {model: ur5e}
steps: [{wait: 1}]
expect:
  - eventually: {joints: {positions: {shoulder_pan_joint: 1.0}, tolerance: 0.01}}
    points: 3
  - always: {within_limits: {velocity: false, effort: false, acceleration: false}}
    points: 1
  - duration: {at_most: 3 s}
    points: 1
"""


@pytest.fixture
def exercise(tmp_path):
    file = tmp_path / "turn.scenario.yaml"
    file.write_text(EXERCISE)
    return file


def table(file, head, rows, separator=","):
    lines = [separator.join(head)] if head else []
    lines += [separator.join(f"{value:.6f}" for value in row) for row in rows]
    file.write_text("\n".join(lines) + "\n")
    return file


def motion(period, target=1.0):
    """Times and joint positions of a smooth turn in two seconds."""
    times = np.arange(0, 2, period)
    turn = target * (1 - np.cos(np.pi * np.clip(times / 1.8, 0, 1))) / 2
    return times, np.column_stack([turn, *[np.full_like(turn, v) for v in (-1.5, 1, -1, -1.5, 0)]])


def test_columns_with_names_are_read_in_any_order(exercise, tmp_path):
    times, rows = motion(0.02)
    head = [*reversed(JOINTS), "gripper_state", "time"]
    content = np.column_stack([rows[:, ::-1], np.zeros(len(times)), times])
    grade = grade_bag(exercise, table(tmp_path / "named.csv", head, content))
    assert (grade.earned, grade.points, grade.notes) == (5, 5, ())


@pytest.mark.parametrize(
    ("period", "separator", "earned"), [(0.01, ",", 5), (0.01, ";", 5), (0.05, "\t", 4)]
)
def test_rows_without_names_are_the_arm_at_a_period(exercise, tmp_path, period, separator, earned):
    """200 rows at 0.01 s take 2 s; at 0.05 s they take 10 s, which is too long."""
    file = table(tmp_path / "rows.csv", [], motion(0.01)[1], separator)
    grade = grade_bag(exercise, file, BagTopics(csv_period=period))
    assert grade.earned == earned
    assert grade.notes[0].startswith("the columns have no names; they are read as shoulder_pan")


def test_a_first_column_more_than_joints_is_the_time(exercise, tmp_path):
    times, rows = motion(0.02)
    grade = grade_bag(exercise, table(tmp_path / "t.csv", [], np.column_stack([times, rows])))
    assert grade.earned == 5


def test_a_turn_that_ends_early_loses_its_points(exercise, tmp_path, capsys):
    file = table(tmp_path / "short.csv", [], motion(0.01, target=0.9)[1])
    assert main(["grade", str(exercise), str(file)]) == 1
    said = capsys.readouterr().out.splitlines()
    assert any(line.startswith("✗       0/3  line 5: eventually: joints") for line in said)
    assert said[-1] == "2 of 5 points"


@pytest.mark.nightly
def test_a_class_that_hands_in_tables_gets_points_and_pages_with_the_arm(exercise, tmp_path):
    """Speeds and efforts are not in the table; the page says so, and shows the arm's meshes."""
    text = "assignment: Turn\nrecording: {scenario: turn.scenario.yaml, csv_period: 10 ms}\n"
    (tmp_path / "turn").mkdir()
    exercise.rename(tmp_path / "turn/turn.scenario.yaml")
    (tmp_path / "turn/assignment.yaml").write_text(text)
    (tmp_path / "all/late").mkdir(parents=True)
    table(tmp_path / "all/good.csv", [], motion(0.01)[1])
    table(tmp_path / "all/late/short.csv", [], motion(0.01, target=0.9)[1])
    (tmp_path / "all/no_joints.csv").write_text("a,b\n1,2\n")
    words = ["grade-class", str(tmp_path / "turn"), str(tmp_path / "all")]
    assert main([*words, "--report-dir", str(tmp_path / "grades")]) == 1
    rows = list(csv.DictReader((tmp_path / "grades/grades.csv").read_text().splitlines()))
    assert {row["submission"]: row["points"] for row in rows} == {
        "good": "5",
        "late": "2",
        "no_joints": "0",
    }
    assert rows[-1]["remark"].startswith("no_joints.csv: the first line names no joint")
    kept = read_run(tmp_path / "grades/students/good/run")
    assert kept.drawings.meshes
    assert (tmp_path / "grades/students/good/run/report.html").is_file()


def test_the_period_of_rows_is_an_option(exercise, tmp_path, capsys):
    file = table(tmp_path / "slow.csv", [], motion(0.01)[1])
    assert main(["grade", str(exercise), str(file), "--csv-period", "0.05"]) == 1
    assert "4 of 5 points" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", 0, "the file is empty"),
        ("1,2,3\n4,5,6\n", 0, "3 columns without names; the arm has 6 joints"),
        ("a,b\n1,2\n", 0, "names no joint of the robot"),
        ("time,elbow_joint\n0,1\n0.1,x\n", 3, "does not have 1 joint positions and a time"),
        ("time,elbow_joint\n0,1\n0.1\n", 3, "does not have"),
        ("time,elbow_joint\n0,1\n-5,1\n", 3, "does not have"),
        ("time,elbow_joint\n0,1\n0.1,nan\n", 3, "does not have"),
        ("elbow_joint,elbow_joint\n0,1\n", 0, "names no joint of the robot once"),
        ("time,elbow_joint\n0,1\n", 0, "at a single time"),
    ],
)
def test_what_is_no_table_of_joints_is_refused_at_its_line(exercise, tmp_path, text, line, words):
    file = tmp_path / "bad.csv"
    file.write_text(text)
    with pytest.raises(SpecError) as refused:
        grade_bag(exercise, file)
    [problem] = refused.value.problems
    assert (problem.path, problem.line) == (str(file), line)
    assert words in problem.message


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (lambda name: f"ur5e_{name}", {"joint_prefix": "ur5e_"}),
        (lambda name: f"left/{name}", {"joint_prefix": "left/"}),
        (lambda name: name.upper(), {"joint_names": {name.upper(): name for name in JOINTS}}),
    ],
)
def test_other_names_of_columns_are_given_by_options(exercise, tmp_path, name, words):
    times, rows = motion(0.02)
    head = ["time", *map(name, JOINTS)]
    file = table(tmp_path / "other.csv", head, np.column_stack([times, rows]))
    with pytest.raises(SpecError) as refused:
        grade_bag(exercise, file)
    hint = refused.value.problems[0].hint
    assert "--joint-prefix PREFIX" in hint
    assert "--joint NAME=RECORDED" in hint
    assert grade_bag(exercise, file, BagTopics(**words)).earned == 5
