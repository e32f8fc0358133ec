"""`harness grade-class`: all submissions of a class, by one assignment."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import output_file, whole_number
from harness.cli.command import EXCHANGE, Command
from harness.cli.output import output, say
from harness.cli.shared_options import add_plugin
from harness.cli.work_bar import WorkBar
from harness.core.printable import counted
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.plugins.grading.classroom.results import ClassGrade
    from harness.reporting.result import CaseResult

TABLE = "grades.csv"


class GradeClassCommand(Command):
    """Grade the submissions of a class by an assignment."""

    name: ClassVar[str] = "grade-class"
    group: ClassVar[str] = EXCHANGE

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness grade-class`."""
        add = command.add_argument
        text = "the folder of an assignment, with its assignment.yaml"
        add("assignment", metavar="ASSIGNMENT", help=text)
        text = "a folder with one folder, archive or file for each student"
        add("submissions", metavar="SUBMISSIONS", help=text)
        add_plugin(command)
        text = "run N cases side by side (default: 1)"
        add("-j", dest="workers", metavar="N", type=whole_number, default=1, help=text)
        text = "write pages and tables into this folder (default: grades)"
        add("--report-dir", metavar="DIR", default="grades", help=text)
        text = "take SUBMISSIONS as the submission of one student"
        add("--one", action="store_true", help=text)
        text = "a CSV of students: the column `submission`, and email, student_id, first_name, ..."
        add("--roster", metavar="FILE", default="", help=text)
        text = "write results.json for Gradescope (with --one)"
        add("--gradescope", metavar="FILE", type=output_file, default="", help=text)
        text = "write result.json for Classroom 50 (with --one)"
        add("--classroom50", metavar="FILE", type=output_file, default="", help=text)

    def run(self, arguments: argparse.Namespace) -> int:
        """Grade, write pages and tables, and print one line for each submission."""
        from harness.plugins.grading.assignment import read_assignment
        from harness.plugins.grading.classroom.pages import write_pages
        from harness.plugins.grading.classroom.run import grade_class
        from harness.plugins.grading.classroom.submissions import find_submissions, one_submission
        from harness.plugins.grading.classroom.tables import read_roster, with_roster, write_tables

        if (arguments.gradescope or arguments.classroom50) and not arguments.one:
            raise UsageError("--gradescope and --classroom50 write one result: add --one")
        loaded, place = read_assignment(Path(arguments.assignment)), Path(arguments.submissions)
        roster = read_roster(Path(arguments.roster)) if arguments.roster else {}
        if arguments.one and not place.exists():
            raise UsageError(f"no such file or folder: '{place}'")
        submissions = [one_submission(place)] if arguments.one else find_submissions(place)
        folder = _new_folder(Path(arguments.report_dir))
        total, done = len(submissions) * (1 + len(loaded.model.hidden)), 0
        work_bar = WorkBar()

        def show(_owner: str, _number: int, _result: CaseResult) -> None:
            nonlocal done
            done += 1
            work_bar("submissions", done, total)

        begun = time.perf_counter()
        grade = grade_class(loaded, submissions, folder, arguments.workers, show)
        grade = with_roster(grade, roster)
        write_tables(grade, folder)
        page = write_pages(grade, folder)
        _write_systems(arguments, grade)
        output().status(None)
        _print(grade)
        seconds = time.perf_counter() - begun
        say(f"{counted(len(submissions), 'submission')} in {seconds:.0f} s", f"page: {page}")
        if arguments.one and (arguments.gradescope or arguments.classroom50):
            return 0  # the systems take another code for a failure of the grader
        is_full = all(each.is_full for each in grade.students)
        return EXIT_CODES["passed" if is_full else "failed"]


def _new_folder(folder: Path) -> Path:
    """An empty folder, or one of earlier grades, whose runs are removed.

    Raises:
        UsageError: It holds something else.
    """
    from harness.plugins.grading.classroom.run import HIDDEN, STUDENTS
    from harness.plugins.grading.classroom.submissions import remove

    if folder.is_file() or (
        folder.is_dir() and any(folder.iterdir()) and not (folder / TABLE).is_file()
    ):
        raise UsageError(f"'{folder}' has other files; name a new folder with --report-dir")
    for name in (STUDENTS, HIDDEN):
        if (folder / name).is_dir():
            remove(folder / name)
    return folder


def _write_systems(arguments: argparse.Namespace, grade: ClassGrade) -> None:
    from harness.plugins.grading.classroom.systems import write_classroom50, write_gradescope

    if arguments.gradescope:
        write_gradescope(grade, Path(arguments.gradescope))
    if arguments.classroom50:
        write_classroom50(grade, Path(arguments.classroom50), os.environ)


def _print(grade: ClassGrade) -> None:
    """One line for each submission: mark, points, name, first reason."""
    from harness.plugins.grading.classroom.tables import number
    from harness.reporting.terminal import Style

    style = Style.of(sys.stdout)
    width = max(len(each.submission.name) for each in grade.students)
    for each in grade.students:
        points = f"{number(each.earned)}/{number(each.points)}"
        name = f"{each.submission.name:<{min(width, 40)}}"
        say(f"{style.mark(each.is_full)} {points:>9}  {name}  {each.remark}".rstrip())
