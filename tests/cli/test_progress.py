import io
import re
import subprocess
import sys
from dataclasses import replace

import pytest

from harness.cli.output import Output
from harness.cli.progress import ProgressLines
from harness.cli.work_bar import pace, remaining
from harness.reporting.progress_events import Judged, StepFinished, StepStarted, Working
from harness.reporting.result import CaseResult
from harness.reporting.terminal import PLAIN, Style
from tests.cli.run_in_terminal import run_in_terminal, screen_lines

SCENARIO = """\
scenario: Too short
robot: open_manipulator_x
steps:
  - wait: 0.3 s
  - wait: 0.1 s
    id: pause
expect:
  - duration: {at_least: 1 s}
"""
RUN = [sys.executable, "-m", "harness.cli", "run", "short.scenario.yaml", "--no-page"]


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


def event(kind, sim_time, wall_time, index=0):
    return kind(index, 2, "pick", sim_time, wall_time)


def reported(stream, *events, style=PLAIN):
    """Lines of progress of one case."""
    lines = ProgressLines(Output(stream), ["a"], is_side_by_side=False, style=style)
    for each in events:
        lines.step(0, each)
    lines.result(0, CaseResult("a", "", "Pick", "passed"))
    return screen_lines(stream.getvalue())[:-1]


@pytest.mark.parametrize("stream", [Terminal, io.StringIO])
def test_a_sample_that_passed_is_no_line(stream):
    written = stream()
    progress = ProgressLines(
        Output(written), ["a", "b", "c"], is_side_by_side=False, style=PLAIN,
        is_brief=True, is_folded=lambda index: index < 2,
    )  # fmt: skip
    for index, outcome in enumerate(("passed", "failed", "passed")):
        progress.step(index, event(StepStarted, 0.0, 0.0))
        progress.result(index, CaseResult("abc"[index], "", "Pick", outcome))
    shown = [line[:9].strip() for line in screen_lines(written.getvalue()) if line[1:3] == "  "]
    assert shown == ["b  failed", "c  passed"]


def test_steps_of_samples_are_not_shown_among_those_of_other_cases():
    written = Terminal()
    progress = ProgressLines(
        Output(written), ["a", "b"], is_side_by_side=False, style=PLAIN, is_folded=lambda i: i == 0
    )
    for index in (0, 1):
        for kind in (StepStarted, StepFinished):
            progress.step(index, event(kind, 1.0, 1.0))
        progress.result(index, CaseResult("ab"[index], "", "Pick", "passed"))
    steps = [line for line in screen_lines(written.getvalue()) if "1/2  pick" in line]
    assert len(steps) == 1


def nested(outcome, message=""):
    """A step with two steps nested in it, of which the second one has an outcome."""
    return [
        event(StepStarted, 10.0, 0.0),
        replace(event(StepStarted, 10.0, 1.0, -1), step="reach"),
        replace(event(StepFinished, 12.0, 2.0, -1), step="reach"),
        replace(event(StepStarted, 12.0, 2.0, -1), step="grasp"),
        replace(event(StepFinished, 13.0, 3.0, -1), step="grasp", status=outcome, message=message),
        replace(event(StepFinished, 13.0, 3.0), status=outcome, message=message),
    ]


def test_a_step_stands_above_those_that_are_nested_in_it():
    lines = reported(Terminal(), *nested("passed"))
    assert lines[1:4] == [
        "    1/2  pick",
        "  ok        reach  t=12.00 s",
        "  ok        grasp  t=13.00 s",
    ]
    assert "pick" not in "".join(lines[4:])


def test_a_failure_inside_a_step_is_reported_once():
    """Its line says that it failed; why is said below, once for the case."""
    lines = reported(Terminal(), *nested("failed", "CONTROL_FAILED: it lags"))
    assert [line for line in lines if line.startswith("  no")] == ["  no        grasp  t=13.00 s"]
    assert "CONTROL_FAILED" not in "".join(lines)
    own = [*nested("passed")[:-1], replace(nested("failed", "TIMED_OUT")[-1])]
    assert "  no 1/2  pick  t=13.00 s" in reported(Terminal(), *own), "its own failure"


def test_speeds_are_shown_where_they_are_requested():
    lines = reported(Terminal(), *nested("passed"), style=Style(is_verbose=True))
    assert lines[2].endswith("reach  t=12.00 s  2.0x real time")
    alone = event(StepStarted, 10.0, 0.0), event(StepFinished, 20.0, 4.0)
    assert reported(Terminal(), *alone, style=Style(is_verbose=True))[1].endswith("2.5x real time")
    assert "real time" not in "".join(reported(Terminal(), *alone))


def test_work_in_parts_has_a_bar_a_rate_and_the_time_that_remains():
    assert pace(0.0, 60.0, 60.0, 20, 80, has_signs=False) == (
        "##-------- 20 of 80, about 3 min left, 20 a minute"
    )
    assert pace(0.0, 1.0, 1.0, 1, 2, has_signs=True) == "█████░░░░░ 1 of 2"
    resumed = pace(0.0, 10.0, 10.0, 60, 80, known=40, has_signs=False)
    assert resumed.endswith("60 of 80, about 10 s left, 2 a second")
    slow = pace(0.0, 600.0, 600.0, 2, 3, has_signs=False)
    assert slow.endswith("2 of 3, about 5 min left"), "a rate below one a minute says nothing more"


def test_the_outcome_is_shown_before_the_report_is_written_and_once():
    passed = CaseResult("a", "", "Pick", "passed")
    stream = Terminal()
    lines = ProgressLines(Output(stream), ["a"], is_side_by_side=False, style=Style())
    lines.step(0, Judged(passed))
    assert "passed  Pick" in stream.getvalue()
    lines.step(0, Working("drawing", 1, 2))
    lines.result(0, passed)
    assert stream.getvalue().count("passed  Pick") == 1
    lines.result(0, replace(passed, outcome="error"))
    assert "error" in stream.getvalue(), "the report could not be written"


def test_piped_a_case_is_one_line():
    lines = reported(io.StringIO(), event(StepStarted, 0.0, 0.0), event(StepFinished, 1.0, 0.1))
    assert len(lines) == 1
    assert lines[0].startswith("a  passed  Pick")


@pytest.mark.nightly
def test_a_terminal_sees_steps_and_both_see_failures_last(tmp_path, monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    (tmp_path / "short.scenario.yaml").write_text(SCENARIO)
    session = run_in_terminal(["run", "short.scenario.yaml", "--no-page"], tmp_path, columns=100)
    seen = session.text
    assert session.code == 1
    assert "\x1b[2K    1/2  wait 0.3 s …  t=0.00 s" in seen, "the step that is under way"
    assert re.search(r"1/2  wait 0.3 s\S*  t=0.30 s", seen)
    assert "real time" not in seen
    piped = subprocess.run(RUN, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert piped.returncode == 1
    assert piped.stderr == ""
    assert "1/2" not in piped.stdout
    assert "\x1b" not in piped.stdout
    lines = piped.stdout.splitlines()
    assert lines[0].startswith("short.scenario.yaml  failed  Too short  2 steps, 0.4 s simulated")
    assert lines[2] == "FAILED short.scenario.yaml: Too short"
    assert lines[3].startswith("  short.scenario.yaml:8: ")
    assert "failed by 0.6 s" in lines[3]
    again = "  again:  harness run short.scenario.yaml"
    report = "reports/short"
    for text in (lines, session.lines[:-1]):
        assert again in text
        assert any(line.startswith("  report: ") and report in line for line in text[-5:])
        assert text[-2].startswith("1 failed of 1 case in ")


CAMERAS = """\
scenario: A long film of two cameras with a title that does not fit into eighty columns at all
robot: open_manipulator_x
cameras:
  - name: overhead
    pose: {xyz: [0.3, 0.0, 0.7]}
    look_at: [0.2, 0.001, 0]
    image: {width: 320, height: 240}
  - name: side
    pose: {xyz: [0.2, 0.6, 0.3]}
    look_at: [0.2, 0, 0.1]
    image: {width: 320, height: 240}
videos: [{camera: overhead, rate: 10 Hz}, {camera: side, rate: 10 Hz}]
objects:
  - {name: red_box, box: {size: [3 cm, 3 cm, 3 cm]}, pose: {xyz: [0.2, 0.1, 0.015]}, mass: 50 g}
steps:
  - gripper: open
  - move_to: home
  - {capture: {camera: overhead}}
  - wait: 1 s
expect:
  - duration: {at_least: 100 s}
"""


@pytest.mark.nightly
def test_no_terminal_is_silent_for_two_seconds_and_no_line_wraps(tmp_path):
    (tmp_path / "film.scenario.yaml").write_text(CAMERAS)
    session = run_in_terminal(["run", "film.scenario.yaml"], tmp_path)
    assert session.code == 1, session.text
    assert session.is_never_silent, session.moments
    assert max(map(len, session.lines)) <= 80, max(session.lines, key=len)
    assert max(len(screen_lines(line)[0]) for line in session.rewritten) <= 80
    said = "\n".join(session.rewritten)
    assert re.search(r"recording the video of camera side, \d+ of \d+", said)
    assert "drawing a picture of each step" in said


@pytest.mark.nightly
def test_a_suite_on_a_terminal_says_how_many_runs_are_done(tmp_path):
    for name in ("first", "second", "third"):
        (tmp_path / f"{name}.scenario.yaml").write_text(SCENARIO)
    session = run_in_terminal(["run", ".", "-j", "2", "--no-page"], tmp_path)
    assert session.is_never_silent, session.moments
    counts = [
        match[0] for each in session.rewritten if (match := re.search(r"\d of 3(?=  )", each))
    ]
    assert (counts[0], counts[-1]) == ("0 of 3", "2 of 3")
    assert not [line for line in session.lines if re.search(r"\d of 3  ", line)], "it is rewritten"


@pytest.mark.nightly
def test_a_terminal_without_control_sequences_gets_none(tmp_path):
    (tmp_path / "short.scenario.yaml").write_text(SCENARIO)
    session = run_in_terminal(["run", "short.scenario.yaml", "--no-page"], tmp_path, TERM="dumb")
    assert session.code == 1
    assert "\x1b" not in session.text
    assert "1/2  wait 0.3 s" in session.text


@pytest.mark.parametrize(("done", "total"), [(3, 8), (120, 500), (4321, 10_000)])
@pytest.mark.parametrize("room", [24, 30, 37, 60])
def test_the_remaining_time_is_what_a_narrow_terminal_leaves_out_last(done, total, room):
    text = pace(0.0, 60.0, 60.0, done, total, has_signs=True, room=room)
    left = remaining(0.0, 60.0, 60.0, done, total)
    assert text.endswith((left, "a minute", "a second"))
    assert left in text
    assert len(text) <= max(room, len(f"{done} of {total}{left}"))
    assert ("█" in text) == (room >= 11 + len(f"{done} of {total}{left}"))


def test_the_time_left_is_estimated_at_the_pace_so_far():
    assert remaining(0.0, 10.0, 10.0, 1, 5) == ", about 40 s left"
    assert remaining(0.0, 10.0, 15.0, 1, 5) == ", about 35 s left"
    assert remaining(0.0, 300.0, 300.0, 10, 40) == ", about 15 min left"
    assert remaining(0.0, 2.0, 2.0, 1, 5) == "", "too early to say"
    assert remaining(0.0, 10.0, 10.0, 0, 5) == ""
    assert remaining(0.0, 10.0, 99.0, 5, 5) == ""


@pytest.mark.parametrize(("columns", "is_named"), [(40, False), (80, True), (200, True)])
def test_the_remaining_time_of_a_suite_is_not_cut_on_a_narrow_terminal(
    columns, is_named, monkeypatch
):
    monkeypatch.setenv("COLUMNS", str(columns))
    now = [0.0]
    stream = Terminal()
    names = [f"rates [sample{number}]" for number in range(60)]
    output = Output(stream)
    lines = ProgressLines(output, names, is_side_by_side=True, style=Style(), clock=lambda: now[0])
    now[0] = 100.0
    for index in range(20):
        lines.result(index, CaseResult("a", "", "Pick", "passed"))
    lines.step(20, Working("measuring distances"))
    output.tick()
    status = stream.getvalue().rpartition("\x1b[2K")[2]
    assert "20 of 60, about 3 min left" in status
    assert ("rates" in status) is is_named
    assert len(status) < columns
