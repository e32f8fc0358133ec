"""`harness course`: a course of exercises, each a file that fails and is to be made to pass."""

from __future__ import annotations

import argparse
import sys
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import output_path
from harness.cli.command import SCENARIOS, Command
from harness.cli.commands.view import open_browser
from harness.cli.files import refuse_existing, write_text
from harness.cli.output import say, say_json, say_text
from harness.cli.shared_options import add_json, add_report_dir
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.plugins.grading.course import Exercise
    from harness.plugins.grading.credit import Credit
    from harness.recording.verdict import Verdict
    from harness.reporting.result import CaseResult


class CourseCommand(Command):
    """Learn with exercises: list them, start one, check it."""

    name: ClassVar[str] = "course"
    group: ClassVar[str] = SCENARIOS

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness course`."""
        parts = command.add_subparsers(dest="part", metavar="PART")
        text = "list the exercises (the default)"
        listed = parts.add_parser("list", help=text, description=text)
        text = "write the file to begin with into a new folder"
        start = parts.add_parser("start", help=text, description=text)
        text = "the number of an exercise, or a folder with assignment.yaml"
        start.add_argument("exercise", metavar="EXERCISE", help=text)
        text = "the folder to write into (default: the name of the exercise)"
        start.add_argument(
            "folder", metavar="FOLDER", type=output_path, nargs="?", default="", help=text
        )
        text = "run what was done so far and print its points"
        check = parts.add_parser("check", help=text, description=text)
        text = "the folder, or the file in it (default: this folder)"
        check.add_argument("work", metavar="FOLDER", nargs="?", default=".", help=text)
        text = "the folder of the exercise, where it is not a bundled one"
        check.add_argument("--assignment", metavar="DIR", default="", help=text)
        add_report_dir(check)
        check.add_argument("--no-open", action="store_true", help="open no browser")
        for each in (listed, check):
            add_json(each)

    def run(self, arguments: argparse.Namespace) -> int:
        """List the exercises, start one or check one."""
        if arguments.part == "start":
            return _start(arguments)
        return _check(arguments) if arguments.part == "check" else _list(arguments)


def _list(arguments: argparse.Namespace) -> int:
    from harness.plugins.grading.course import exercises

    found = exercises()
    if getattr(arguments, "json", False):
        say_json([_facts(number, exercise) for number, exercise in found.items()])
        return 0
    for number, exercise in found.items():
        model = exercise.assignment.model
        minutes = f"{model.minutes:3} min" if model.minutes else ""
        say(f"{number:3}  {minutes}  {model.assignment}", f"{'':14}{model.description}")
    say("", "the minutes are estimates; begin with one: harness course start 1")
    return 0


def _facts(number: int, exercise: Exercise) -> dict[str, object]:
    model = exercise.assignment.model
    return {
        "number": number,
        "name": exercise.folder_name,
        "title": model.assignment,
        "minutes": model.minutes,
        "teaches": model.description,
    }


def _start(arguments: argparse.Namespace) -> int:
    from harness.plugins.grading.course import find_exercise

    exercise = find_exercise(arguments.exercise)
    folder = Path(arguments.folder or exercise.folder_name)
    file = folder / exercise.file_name
    refuse_existing(file)
    write_text(file, exercise.start.read_text(encoding="utf-8"))
    model = exercise.assignment.model
    say(f"{model.assignment}: {model.description}", f"wrote {file}")
    own = f" --assignment {arguments.exercise}" if Path(arguments.exercise).is_dir() else ""
    say(f"edit it, then: harness course check {folder}{own}")
    return 0


def _check(arguments: argparse.Namespace) -> int:
    from harness.plugins.grading.course import find_work, read_exercise, run_work, test_solver

    own = read_exercise(Path(arguments.assignment)) if arguments.assignment else None
    exercise, file = find_work(Path(arguments.work), own)
    report = Path(arguments.report_dir) / "course" / exercise.folder_name
    if exercise.assignment.model.kind == "ik":
        with redirect_stdout(sys.stderr if arguments.json else sys.stdout):
            verdicts, credit = test_solver(exercise, file, report)
        return _show_properties(verdicts, credit, exercise, arguments)
    return _show_case(run_work(exercise, file, report), file, arguments)


def _show_case(case: CaseResult, file: Path, arguments: argparse.Namespace) -> int:
    """Print failed steps, points with reasons and the page of a run."""
    from harness.plugins.grading.commands.grade import print_grade
    from harness.plugins.grading.credit import credit_of_run
    from harness.plugins.grading.points import Grade, graded
    from harness.reporting.terminal import Style, report_link

    credit = credit_of_run(is_idle=case.is_idle, is_full=case.outcome == "passed")
    rows = graded([replace(each, line=0) for each in case.verdicts if not each.step], credit)
    notes = tuple(note for note in case.notes if ": warning: " not in note)  # the rows have them
    grade = Grade(None, rows, (*notes, *credit.notes))
    code = EXIT_CODES[case.outcome] or (0 if grade.is_full else EXIT_CODES["failed"])
    if arguments.json:
        points = {"points": grade.points, "earned": grade.earned, "rows": rows}
        say_json({"outcome": case.outcome, "problems": case.problems, **points})
        return code
    for problem in case.problems:
        say_text(str(problem))
    if case.outcome == "invalid":
        return code
    place = file if Path(case.file).name == file.name else Path(case.file).name
    for step in case.steps:
        if step.status == "failed":
            say(f"{place}:{step.line}: step `{step.title}` failed, {step.error_code}:")
            say(f"    {step.message}", *(f"    {line}" for line in step.explanation))
    if case.message:
        say(case.message)
    print_grade(grade)
    if code and grade.is_full:
        say("not passed: every point is earned, but a step or what it expects failed")
    if case.page:
        say(f"report: {report_link(case, Style.of(sys.stdout))}")
        if not arguments.no_open:
            open_browser(Path(case.page).resolve().as_uri())
    return code


def _show_properties(
    verdicts: tuple[Verdict, ...], credit: Credit, exercise: Exercise, arguments: argparse.Namespace
) -> int:
    """Print the points of the properties that a function keeps."""
    from harness.plugins.grading.points import Grade, graded

    whole = sum(each.points or 0.0 for each in verdicts)
    scale = (exercise.assignment.model.points or whole) / whole
    scaled = [replace(each, points=scale * (each.points or 0.0)) for each in verdicts]
    grade = Grade(None, graded(scaled, credit), ())
    if arguments.json:
        say_json({"points": grade.points, "earned": grade.earned, "rows": grade.rows})
    else:
        why = f": {credit.reason}" if credit.reason else ""
        say("", f"{grade.earned:.3g} of {grade.points:g} points{why}")
    return 0 if grade.is_full else EXIT_CODES["failed"]
