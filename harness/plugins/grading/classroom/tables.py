"""Tables of a class: CSV for people, nbgrader, Moodle and Canvas, and JUnit XML."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.core.files import replaced, writing
from harness.core.registry import registry
from harness.language.files.yaml_file import read_text
from harness.plugins.grading.classroom.results import ClassGrade, StudentGrade
from harness.reporting.result import CaseResult
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.suite_reporter import SuiteReporter

TABLES = ("grades.csv", "nbgrader.csv", "moodle.csv", "canvas.csv", "junit.xml")
PERSON = ("student_id", "first_name", "last_name", "email", "canvas_id", "sis_id", "login")
"""Columns of a roster besides `submission`; `section` as well."""

NBGRADER = (
    *("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email"),
    *("raw_score", "late_submission_penalty", "score", "max_score"),
)
"""The columns that nbgrader's own export has [1].

References:
    [1] jupyter/nbgrader, nbgrader/plugins/export.py.
"""

Rows = Sequence[Sequence[str]]


def read_roster(path: Path) -> dict[str, dict[str, str]]:
    """What a CSV file says of each student, by the name of the submission.

    Raises:
        SpecError: It has no column `submission`, or names one twice.
    """
    lines = read_text(path, kind="CSV of students").splitlines()
    reader = csv.DictReader(lines)
    known = {"submission", "section", *PERSON}
    try:
        columns, rows = reader.fieldnames or (), [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise SpecError([Problem(str(path), reader.line_num, 1, f"is no CSV: {error}")]) from error
    if "submission" not in columns:
        message = "the first line names no column `submission`"
        raise SpecError([Problem(str(path), 1, 1, message, f"columns: {', '.join(sorted(known))}")])
    found: dict[str, dict[str, str]] = {}
    for number, row in rows:
        name = row["submission"]
        if name in found:
            raise SpecError([Problem(str(path), number, 1, f"'{name}' is there twice")])
        found[name] = {key: value or "" for key, value in row.items() if key in known}
    return found


def with_roster(grade: ClassGrade, roster: Mapping[str, Mapping[str, str]]) -> ClassGrade:
    """The grades with what a roster says of the students."""
    students = [
        replace(each, person=dict(roster.get(each.submission.name, {}))) for each in grade.students
    ]
    return replace(grade, students=tuple(students))


def write_tables(grade: ClassGrade, folder: Path) -> None:
    """Write every table into a folder; each is whole or as it was.

    Raises:
        HarnessError: A file cannot be written.
    """
    makers: dict[str, Callable[[ClassGrade], Rows]] = {
        "grades.csv": _grades,
        "nbgrader.csv": _nbgrader,
        "moodle.csv": _moodle,
        "canvas.csv": _canvas,
    }
    for name, rows in makers.items():
        with writing(folder), replaced(folder / name) as file:
            file.write(_csv(rows(grade)).encode())
    results = [SuiteCase(result) for each in grade.students for result in _named(each)]
    is_full = all(each.is_full for each in grade.students)
    kind: type[SuiteReporter] = registry(SuiteReporter.plugin_kind).find("junit")
    junit = kind(SuiteRecord("passed" if is_full else "failed", results))
    for case in results:
        junit.add(case)
    with writing(folder), replaced(folder / "junit.xml") as file:
        junit.write(file)


def _named(student: StudentGrade) -> list[CaseResult]:
    """The results of a student's cases under the student's name."""
    name = student.submission.name
    if not student.runs:
        return [CaseResult(name, "public", name, "invalid", message=student.problem)]
    return [
        replace(run.result, file=name, case=run.result.case or "public") for run in student.runs
    ]


def number(value: float) -> str:
    """Points with at most four decimals."""
    return f"{value:.4f}".rstrip("0").rstrip(".")


def _csv(rows: Rows) -> str:
    text = io.StringIO()
    csv.writer(text).writerows([[_cell(each) for each in row] for row in rows])
    return text.getvalue()


def _cell(text: str) -> str:
    """A text that no spreadsheet takes for a formula; names of submissions are anybody's."""
    plain = " ".join(text.split())
    return f"'{plain}" if plain[:1] in "=+-@" and not _is_number(plain) else plain


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return not text
    return True


def _grades(grade: ClassGrade) -> Rows:
    """For people: points of each expectation, and the first reason for lost ones."""
    head = ["submission", "points", "max_points", *(each.text for each in grade.criteria)]
    rows = [[*head, "remark"]]
    for each in grade.students:
        parts = [number(each.earned_of(i)) for i in range(len(grade.criteria))]
        totals = [number(each.earned), number(each.points)]
        rows.append([each.submission.name, *totals, *parts, each.remark])
    return rows


def _nbgrader(grade: ClassGrade) -> Rows:
    rows = [list(NBGRADER)]
    for each in grade.students:
        person, score = each.person, number(each.earned)
        row = [grade.assignment.name, "", "", person.get("student_id") or each.submission.name]
        row += [person.get(key, "") for key in ("last_name", "first_name", "email")]
        rows.append([*row, score, "0", score, number(each.points)])
    return rows


def _moodle(grade: ClassGrade) -> Rows:
    """Moodle maps columns in a form; users are found by e-mail address or ID number."""
    rows = [["Email address", "ID number", "Submission", grade.assignment.model.assignment]]
    rows[0].append("Feedback")
    for each in grade.students:
        who = [each.person.get("email", ""), each.person.get("student_id", "")]
        rows.append([*who, each.submission.name, number(each.earned), each.remark])
    return rows


def _canvas(grade: ClassGrade) -> Rows:
    """Canvas finds users by `ID`, SIS IDs or names, and the assignment by its title [1].

    References:
        [1] instructure/canvas-lms, lib/gradebook_importer.rb.
    """
    title = grade.assignment.model.assignment
    points = number(sum(each.points for each in grade.criteria))
    rows = [["Student", "ID", "SIS User ID", "SIS Login ID", "Section", title]]
    rows.append(["Points Possible", "", "", "", "", points])
    for each in grade.students:
        person = each.person
        name = " ".join(filter(None, (person.get("first_name"), person.get("last_name"))))
        ids = [person.get(key, "") for key in ("canvas_id", "sis_id", "login", "section")]
        rows.append([name or each.submission.name, *ids, number(each.earned)])
    return rows
