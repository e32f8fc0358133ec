import io
import json
import math
from dataclasses import replace

import pytest

from harness.core.errors import Problem
from harness.core.printable import terminal_text
from harness.recording.verdict import Measure, Verdict
from harness.reporting.json_text import compact_json, json_text
from harness.reporting.progress_events import StepFinished, StepStarted
from harness.reporting.result import CaseResult, StepLine
from harness.reporting.terminal import (
    Style,
    case_line,
    failure,
    repeats,
    step_done,
    step_running,
    summary,
)

COLORED = Style(has_color=True, has_signs=True)


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


def result(outcome="passed", **more):
    return CaseResult("a.scenario.yaml", "", "Pick", outcome, **more)


def finished(status, message="", index=2, total=16):
    return StepFinished(index, total, "move_to mogi_home", 4.25, 0.0, status, message)


def test_colours_are_for_terminals_that_show_them(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert Style.of(Terminal()) == COLORED
    assert not Style.of(io.StringIO()).has_color
    monkeypatch.setenv("NO_COLOR", "1")
    assert not Style.of(Terminal()).has_color


def test_signs_are_for_encodings_that_have_them():
    ascii_stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    assert not Style.of(ascii_stream).has_signs
    assert step_done(finished("passed")).isascii()
    assert failure(result("failed", steps=(StepLine("s", "lin", "lin", "failed"),))).isascii()


def test_a_step_is_one_line_with_number_and_time_and_its_cause_comes_below():
    assert step_done(finished("passed")) == "  ok  3/16  move_to mogi_home  t=4.25 s"
    failed = finished("failed", "GOAL_IN_COLLISION: wrist_3 and Table\nmore")
    assert step_done(failed) == "  no  3/16  move_to mogi_home  t=4.25 s"
    assert (
        step_running(StepStarted(2, 16, "move_to mogi_home", 4.25))
        == "     3/16  move_to mogi_home ...  t=4.25 s"
    )


def test_speed_is_reported_of_steps_and_cases_that_moved():
    verbose = Style(is_verbose=True)
    fast = step_done(replace(finished("passed"), speed=12.4), verbose)
    assert fast.endswith("  t=4.25 s  12x real time")
    assert step_done(replace(finished("passed"), speed=0.84), verbose).endswith("  0.8x real time")
    assert step_done(replace(finished("passed"), speed=0.0), verbose).endswith("  t=4.25 s")
    assert step_done(replace(finished("passed"), speed=12.4)).endswith("  t=4.25 s")
    moved = result(sim_time=9.0, wall_times={"plan": 0.5, "simulate": 1.0}, digest="0123456789abcd")
    assert "9.0 s simulated at 6.0x real time" in case_line(moved, verbose)
    assert case_line(moved, verbose).endswith("  digest 0123456789ab")
    assert "real time" not in case_line(moved)
    assert "digest" not in case_line(moved)


def test_a_failed_step_is_reported_with_place_code_report_and_command():
    step = StepLine(
        "s", "lin", "lin to above", "failed", "NO_IK_SOLUTION", "0.4 m out of reach", line=14
    )
    text = failure(
        result("failed", steps=(step,), report_dir="reports/a"),
        again="harness run a.scenario.yaml --seed 7",
    )
    assert text.splitlines() == [
        "FAILED a.scenario.yaml: Pick",
        "  a.scenario.yaml:14: lin to above: NO_IK_SOLUTION: 0.4 m out of reach",
        "  report: reports/a",
        "  again:  harness run a.scenario.yaml --seed 7",
    ]


def test_a_failed_expectation_is_reported_with_every_number():
    measure = Measure("height above start", 0.012, 0.05, ">=", "m", 7.2, "red_box")
    verdict = Verdict(
        "lifted red_box above 5 cm",
        "failed",
        margin=-0.038,
        unit="m",
        time=7.2,
        line=30,
        reason="it rose 1.2 cm",
        measures=(measure,),
    )
    unseen = Verdict("sees red_box", "not observable", reason="no camera", line=31)
    held = Verdict("static", "passed", margin=1.0)
    lines = failure(result("failed", verdicts=(verdict, unseen, held))).splitlines()
    assert lines[1] == (
        "  a.scenario.yaml:30: lifted red_box above 5 cm: failed by 38.0 mm at t=7.200 s:"
        " it rose 1.2 cm"
    )
    assert lines[2] == (
        "      height above start: 12.0 mm (at least 50.0 mm) at t=7.200 s (red_box)"
    )
    assert lines[3] == "  a.scenario.yaml:31: sees red_box: not observable: no camera"
    assert len(lines) == 4


def test_an_invalid_file_shows_the_lines_and_not_their_summary_again():
    problem = Problem("a.scenario.yaml", 3, 8, "no world 'moon'", "worlds: empty", "world: moon", 4)
    lines = failure(result("invalid", problems=(problem,), message="no world 'moon'")).splitlines()
    assert lines[1:] == [
        "  a.scenario.yaml:3:8: no world 'moon'",
        "      3 | world: moon",
        "        |        ^^^^ worlds: empty",
    ]


def test_an_error_reports_its_message():
    text = failure(result("error", message="its process was ended by SIGSEGV"))
    assert "ERROR a.scenario.yaml: Pick\n  its process was ended by SIGSEGV" in text


def test_a_finished_case_is_one_line():
    verdicts = (Verdict("x", "passed"), Verdict("y", "failed"))
    line = case_line(
        result("failed", steps=(StepLine("s", "lin", "lin", "passed"),), sim_time=3.25,
               verdicts=verdicts, digest="0123456789abcdef")
    )  # fmt: skip
    assert line == ("failed  Pick  1 step, 3.2 s simulated  1 of 2 expectations hold")


@pytest.mark.parametrize(
    ("statuses", "text"),
    [
        (["passed"], "1 of 1 expectation holds"),
        (["failed"], "0 of 1 expectation holds"),
        (["passed", "failed", "not reached"], "1 of 3 expectations hold"),
        ([], "expects nothing"),
    ],
)
def test_the_number_of_expectations_that_hold_is_a_sentence(statuses, text):
    verdicts = tuple(Verdict("x", status) for status in statuses)
    assert case_line(result("failed", verdicts=verdicts)).endswith(f"  {text}")


def test_colours_take_no_room():
    line = terminal_text(case_line(result(), COLORED))
    assert (
        line.replace("\x1b[32m", "")
        .replace("\x1b[1m", "")
        .replace("\x1b[0m", "")
        .startswith("passed  Pick  ")
    )


def test_the_summary_counts_the_gravest_first():
    results = ["passed", "error", "passed"]
    assert summary(results, 2.0) == "1 error, 2 passed of 3 cases in 2.0 s"
    assert "\x1b[31m1 error\x1b[0m" in terminal_text(summary(results, 2.0, COLORED))
    assert summary([], 0.0).startswith("nothing was run")


def test_repeats_report_whether_the_digests_are_the_same():
    assert repeats([result(digest="ab"), result(digest="ab")]) == "ok 2 runs, one digest: ab"
    differ = repeats([result(digest="ab"), result(digest="cd"), result("error")])
    digests = "1 x ab; 1 x cd; 1 x no digest (error)"
    assert differ.startswith(f"no 3 runs, 3 digests: {digests}; `harness compare` prints where")


@pytest.mark.parametrize("title", ["Pick", "a name of no encoding: \\udc80"])
def test_json_is_strict_where_numbers_are_not_finite(title):
    verdicts = (Verdict("x", "passed", margin=math.inf), Verdict("y", "failed", margin=-math.inf))
    document = {"results": [replace(result(verdicts=verdicts), title=title)]}

    def margins(text):
        read = json.loads(text)["results"][0]
        assert read["title"] == title
        return [verdict["margin"] for verdict in read["verdicts"]]

    assert margins(json_text(document)) == [None, None]
    assert margins(compact_json(document)) == [None, None]
    strings = compact_json(document, not_finite="strings")
    assert margins(strings) == ["Infinity", "-Infinity"]
    assert "\\n" not in strings
