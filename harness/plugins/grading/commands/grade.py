"""`harness grade`: a recording of another program, by a scenario's expectations."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import pair, seconds
from harness.cli.command import EXCHANGE, Command
from harness.cli.files import one_scenario
from harness.cli.output import say, say_json
from harness.cli.shared_options import (
    add_json,
    add_overrides,
    add_package_path,
    add_plugin,
    add_report_options,
)
from harness.cli.suite_output import show_case
from harness.core.registry import registry
from harness.suite.case_runner import CaseRunner, case_runner
from harness.suite.discovery import UsageError
from harness.suite.folders import report_folders
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.plugins.grading.points import Grade, Graded

DOUBTS = ("publishers", "tf", "frames", "steps", "velocities", "jumps", "once")
EXAMPLE = "red_box=/red_box/pose"


class GradeCommand(Command):
    """Grade a recording of another program by a scenario."""

    name: ClassVar[str] = "grade"
    group: ClassVar[str] = EXCHANGE
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness grade`."""
        add = command.add_argument
        add("scenario", metavar="SCENARIO", help="a scenario file, or a bundled name")
        add_plugin(command)
        text = "a rosbag2 folder, an .mcap, .db3, .csv or ROS 1 .bag file; or give --node"
        add("bag", metavar="BAG", nargs="?", default="", help=text)
        for runner in _runners():
            runner.add_options(command)
        add_report_options(command, grades_recordings=True)
        command.set_defaults(nodes=[])
        text = "give the nodes this simulated time where no step is `external` (default: 60)"
        add("--timeout", metavar="SECONDS", type=seconds, default=60.0, help=text)
        text = "read the joint positions from this topic (default: /joint_states)"
        add("--joint-states", metavar="TOPIC", default="/joint_states", help=text)
        text = "what the recorded names of joints and links begin with, and the robot's do not"
        add("--joint-prefix", metavar="PREFIX", default="", help=text)
        add(
            "--joint",
            metavar="NAME=RECORDED",
            dest="joints",
            action="append",
            type=_recorded_joint,
            default=[],
            help="read a joint of the robot under another name",
        )
        text = "the time between rows of a .csv without a column of times (default: 0.01)"
        add("--csv-period", metavar="SECONDS", type=seconds, default=0.01, help=text)
        text = (
            "read poses of objects by name from this topic: TFMessage, as Gazebo's bridge sends"
            " them, or ModelStates"
        )
        add("--objects", metavar="TOPIC", action="append", default=[], help=text)
        add(
            "--object",
            metavar="NAME=TOPIC",
            dest="object_poses",
            action="append",
            type=_object_topic,
            default=[],
            help="read the pose of one object from this topic",
        )
        add_overrides(command)
        text = f"award points in spite of a doubt about the recording: {', '.join(DOUBTS)}"
        add(
            "--allow",
            metavar="DOUBT",
            dest="allowed",
            action="append",
            default=[],
            choices=DOUBTS,
            help=text,
        )
        add_package_path(command)
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Judge a recording and print points with reasons."""
        if bool(arguments.bag) == bool(arguments.nodes):
            raise UsageError("give either a recording (BAG) or a command (--node) to grade")
        if arguments.nodes:
            return _run_node(arguments)
        scenario = one_scenario(arguments.scenario)
        from harness.plugins.grading.bag.content import BagTopics
        from harness.plugins.grading.grade import grade_bag

        topics = BagTopics(
            arguments.joint_states,
            arguments.joint_prefix,
            {recorded: name for name, recorded in arguments.joints},
            tuple(arguments.objects),
            dict(arguments.object_poses),
            csv_period=arguments.csv_period,
        )
        bag, folder = Path(arguments.bag), None
        if arguments.report_dir and not arguments.no_report:
            folder = report_folders([scenario], Path(arguments.report_dir))[0] / bag.stem
        options = dict(arguments.overrides), arguments.allowed, folder
        grade = grade_bag(scenario, bag, topics, *options)
        if arguments.json:
            say_json(_document(grade))
            return _code(grade)
        print_grade(grade)
        if folder is not None:
            say(f"report: {folder}")
        return _code(grade)


def _runners() -> list[CaseRunner]:
    """What can run the programs of a student; nothing where ROS 2's plug-in is absent."""
    return [case_runner("nodes")] if "nodes" in registry("case_runner").built_in_modules else []


def _object_topic(text: str) -> tuple[str, str]:
    """`NAME=TOPIC` of an object's pose."""
    name, topic = pair(text, "NAME=TOPIC", EXAMPLE)
    if not topic.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=TOPIC, as in {EXAMPLE}")
    return name, topic.strip()


def _recorded_joint(text: str) -> tuple[str, str]:
    """`NAME=RECORDED` of a joint."""
    return pair(text, "NAME=RECORDED", "elbow_joint=left_elbow")


def _run_node(arguments: argparse.Namespace) -> int:
    """Grade what a student's node does with the simulated robot."""
    arguments.report_dir = arguments.report_dir or "reports"
    code, document = _graded_node(arguments)
    if arguments.json:
        say_json(document)
    return code


def _graded_node(arguments: argparse.Namespace) -> tuple[int, object]:
    from harness.plugins.grading.credit import credit_of_run
    from harness.plugins.grading.points import Grade, graded
    from harness.recording.read_run import read_run

    case = case_runner("nodes").run_command(arguments, arguments.timeout)
    if case.outcome in ("invalid", "error"):
        if not arguments.json:
            show_case(case, one_scenario(arguments.scenario))
        problems = [str(problem) for problem in case.problems]
        code = EXIT_CODES[case.outcome]
        failed = {"outcome": case.outcome, "message": case.message, "problems": problems}
        return code, {"format": "armharness-grade/1", "exit_code": code, **failed}
    run = read_run(Path(case.report_dir)).run if case.report_dir else None
    credit = credit_of_run(is_idle=case.is_idle, is_full=case.outcome == "passed")
    notes = (*case.notes, *credit.notes)
    grade = Grade(run, graded(case.verdicts, credit), notes)
    code = _code(grade) if case.outcome == "passed" else EXIT_CODES["failed"]
    if not arguments.json:
        for step in case.steps:
            if step.status == "failed":
                say(f"{step.title} failed, {step.error_code}: {step.message}")
        print_grade(grade)
        if code != _code(grade):
            say("not passed: every point is earned, but a step failed")
        if case.report_dir:
            say(f"report: {case.report_dir}")
    return code, {**_document(grade), "exit_code": code}


def _code(grade: Grade) -> int:
    """The exit code: 0 when every point is earned; expectations without points do not count."""
    return 0 if grade.is_full else EXIT_CODES["failed"]


def print_grade(grade: Grade) -> None:
    """Print each expectation with its points and its reason, and the sum."""
    from harness.reporting.terminal import Style, measure_text, verdict_line

    style = Style.of(sys.stdout)
    for note in grade.notes:
        say(f"note: {note}")
    for row in grade.rows:
        verdict = row.verdict
        place = f"line {verdict.line}: " if verdict.line else ""
        is_seen = verdict.status != "not observable"
        mark = style.mark(verdict.status == "passed") if is_seen else "?"
        say(f"{mark} {_points(row):>9}  {place}{verdict.expectation}: {verdict_line(verdict)}")
        for warning in verdict.warnings:
            say(f"{'':15}warning: {warning}")
        if verdict.status == "failed":
            for measure in verdict.measures:
                say(f"{'':15}{measure_text(measure)}")
    text = f"{grade.earned:g} of {grade.points:g} points"
    if grade.withheld:
        kinds = dict.fromkeys(kind for row in grade.rows for kind in row.withheld)
        text += f"; {grade.withheld:g} of them are withheld: " + ", ".join(
            f"--allow {kind}" for kind in kinds
        )
    if grade.open:
        text += f"; {grade.open:g} of them cannot be seen in this recording"
    say(text)


def _points(row: Graded) -> str:
    if not row.points:
        return "no points"
    if row.verdict.status == "not observable" and not row.is_withheld:
        return f"?/{row.points:g}"
    mark = "*" if row.is_withheld else ""
    return f"{row.earned:g}{mark}/{row.points:g}"


def _document(grade: Grade) -> dict[str, object]:
    return {
        "format": "armharness-grade/1",
        "exit_code": _code(grade),
        "recording": grade.run.file if grade.run is not None else "",
        "points": grade.points,
        "earned": grade.earned,
        "not_observable": grade.open,
        "withheld": grade.withheld,
        "rows": grade.rows,
        "notes": grade.notes,
    }
