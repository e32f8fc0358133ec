"""`harness compare`: what changed from one saved run to another."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.plugins.comparison.compare import MOST, compare, line_changes
from harness.plugins.comparison.farthest import farthest_apart
from harness.plugins.comparison.lines import comparison_lines
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict
from tests.judging.synthetic_run import ROBOT, make_run
from tests.running import run_case

PICK = Path(__file__).parents[2] / "scenarios/lessons/04_ur_pick_by_friction.scenario.yaml"


WAIT = """\
scenario: wait
robot: open_manipulator_x
steps: [{wait: 0.1 s}]
expect:
  - duration: {at_least: 50 ms}
"""
FASTER = {"overrides": {"planning.max_velocity_scaling_factor": "0.2"}}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Pages are written below the working folder."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def compared(recorded_run, capsys):
    """Compares the lesson with another run of it: the exit code, and what is printed."""

    def comparison(second, *options):
        first = recorded_run(PICK) / "run"
        code = main(["compare", str(first), str(second), *options])
        return code, capsys.readouterr().out

    return comparison


@pytest.mark.nightly
def test_equal_runs_are_the_same(compared, tmp_path):
    run_case(PICK, report_dir=tmp_path / "again", stills=False, page=False)
    code, text = compared(tmp_path / "again")
    assert code == 0
    assert text.startswith("same  equal digests")
    assert len(text.splitlines()) == 1


def test_another_verdict_on_the_same_motion_is_reported_with_both_margins(recorded_run, capsys):
    first = recorded_run(WAIT) / "run"
    second = recorded_run(WAIT, overrides={"expect.0.duration.at_least": "2 s"}, outcome="failed")
    code, text = main(["compare", str(first), str(second / "run")]), capsys.readouterr().out
    assert code == 1
    assert "different  the recorded signals are the same; commands or verdicts differ" in text
    assert "outcome\n  passed -> failed" in text
    assert "duration is at least 0.05 → 2.0 s: passed by 0.05 s -> failed by 1.9 s" in text
    assert "trajectories" not in text
    expected = "duration: {at_least: %s}"
    assert f"scenario\n  {expected % '50 ms'} -> {expected % '2 s'}\nverdicts" in text


@pytest.mark.nightly
def test_another_speed_reports_step_signal_durations_and_margins(compared, recorded_run):
    code, text = compared(recorded_run(PICK, **FASTER) / "run", "--json")
    assert code == 1
    comparison = json.loads(text)["comparison"]
    first = comparison["first_difference"]
    assert first["step"].startswith("pick ")
    assert first["signal"].startswith("joint_command")
    assert first["before"] != first["after"]
    kinds = {change["what"] for change in comparison["changes"]}
    assert {"duration", "trajectory", "margin"} <= kinds


def test_a_folder_without_a_run_is_wrong_usage(recorded_run, tmp_path, capsys):
    assert main(["compare", str(recorded_run(WAIT) / "run"), str(tmp_path)]) == 2
    assert "is not the folder of a run" in capsys.readouterr().err


def test_another_version_of_the_file_is_reported_by_its_lines_and_its_steps(tmp_path, capsys):
    text = """\
scenario: wait
robot: {model: ur3e, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
steps:
  - wait: 0.1 s
  - STEP
"""
    for name, step in (("one", "wait: 0.2 s"), ("two", "settle: {}")):
        file = tmp_path / "wait.scenario.yaml"
        file.write_text(text.replace("STEP", step))
        run_case(file, report_dir=tmp_path / name, stills=False, page=False)
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two")]) == 1
    said = capsys.readouterr().out
    assert "steps\n  wait 0.2 s: passed -> -\n  settle: - -> passed" in said
    assert "wait 0.1 s:" not in said
    scenario = said[said.index("scenario\n") : said.index("steps\n")]
    assert "wait" in scenario
    assert "settle" in scenario


def test_many_changed_lines_are_counted():
    texts = ["\n".join(f"{word} {n}" for n in range(50)) for word in ("a", "b")]
    changes = line_changes(*(StoredRun(make_run(), (), "passed", "", {}, text) for text in texts))
    assert changes[0] == ("a 0", "b 0")
    assert changes[MOST] == ("30 more lines", "30 more lines")


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (Verdict("path", "passed", 0.05, "1"), Verdict("path", "failed", -0.2, "1"),
         "path: passed by 0.05 -> failed by 0.2"),
        (Verdict("path", "passed", 0.05, "1"), Verdict("path", "passed", 0.04, "1"),
         "path: 0.05 -> 0.04 (-0.01)"),
        (Verdict("path", "passed", 0.05, "1"), Verdict("path", "passed", 0.003, "m"),
         "path: 0.05 -> 3.0 mm"),
        (Verdict("path", "passed", 0.05, "m"), Verdict("path", "passed", 0.04, "m"),
         "path: 50.0 mm -> 40.0 mm (-10.0 mm)"),
        (Verdict("path", "passed", 0.05, "m"), Verdict("path", "failed", -1e-9, "m"),
         "path: passed by 50.0 mm -> failed by 1.0e-06 mm"),
    ],
)  # fmt: skip
def test_a_plain_number_has_no_unit(before, after, said):
    run = make_run()
    stored = [StoredRun(run, (each,), "passed", each.status, {}) for each in (before, after)]
    assert f"  {said}" in list(comparison_lines(compare(*stored)))


def test_runs_of_different_robots_are_compared_by_their_names():
    """Joints that one run has and the other has not are no reason to stop."""
    other = replace(ROBOT, name="one_joint", joints=ROBOT.joints[:2], gripper=None)
    stored = [StoredRun(run, (), "passed", run.robot.name, {})
              for run in (make_run(), make_run(150, robot=other))]  # fmt: skip
    comparison = compare(*stored)
    assert not comparison.is_same
    assert "  hand -> one_joint" in list(comparison_lines(comparison))


def test_margins_that_people_read_as_equal_are_no_change():
    stored = [StoredRun(make_run(), (Verdict("path", "passed", margin, "rad"),), "passed", "", {})
              for margin in (1.5, 1.5 + 1e-9)]  # fmt: skip
    assert compare(*stored).changes == ()


def test_the_tool_and_objects_are_named_where_they_are_farthest_apart():
    times = np.linspace(0.0, 1.99, 200)
    moved = np.tile([0.3, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0], (200, 1))
    away = moved.copy()
    away[100:, 1] = 0.25 * (times[100:] - 1.0)
    runs = [make_run(object_poses={"box": each}) for each in (moved, away)]
    [box] = farthest_apart(*runs)
    assert (box.name, box.time) == ("box", pytest.approx(1.99))
    assert box.distance == pytest.approx(0.2475)
    stored = [StoredRun(run, (), "passed", str(n), {}) for n, run in enumerate(runs)]
    lines = list(comparison_lines(compare(*stored)))
    assert "  box is farthest apart at t=1.990 s, by 248 mm" in lines


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("contact_forces", "contact force between box and bin is 1.0 N and 2.0 N"),
        ("support_forces", "support between box and bin is 1.0 N and 2.0 N"),
    ],
)
def test_forces_of_two_bodies_are_named_with_their_unit(name, words):
    runs = [make_run(**{name: {("box", "bin"): np.full(200, value)}}) for value in (1.0, 2.0)]
    stored = [StoredRun(run, (), "passed", str(n), {}) for n, run in enumerate(runs)]
    assert words in "\n".join(comparison_lines(compare(*stored)))


@pytest.mark.parametrize(
    ("first", "second", "names"),
    [
        (["height is 5.0 mm"], ["height is 7.0 mm"], ["height is 5.0 → 7.0 mm"]),
        (["at (1, -2, 3) mm"], ["at (1, 2, 3) mm"], ["at (1, -2 → 2, 3) mm"]),
        (["up 1 s", "up 2 s"], ["up 3 s", "up 2 s"], ["up 1 → 3 s"]),
        (["up 1 s"], ["up 2 s", "up 3 s"], ["up 1 → 2 s", "up 3 s"]),
        (["up 1 s"], ["down 1 s"], ["up 1 s", "down 1 s"]),
    ],
)
def test_an_expectation_whose_numbers_changed_is_one_change(first, second, names):
    run = make_run()
    stored = [
        StoredRun(run, tuple(verdict(text, status) for text in texts), "passed", "0" * 64, {})
        for texts, status in ((first, "passed"), (second, "failed"))
    ]
    changes = compare(*stored).changes
    kept = {*first} & {*second}
    assert [
        each.name for each in changes if each.what == "verdict" and each.name not in kept
    ] == names


def verdict(text, status):
    return Verdict(text, status, 0.1, "m", 0.5)
