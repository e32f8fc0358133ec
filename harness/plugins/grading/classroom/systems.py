"""Results of one submission for Gradescope and Classroom 50."""

from __future__ import annotations

import math
import subprocess
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from harness.core.files import replaced, writing
from harness.plugins.grading.classroom.results import ClassGrade, Mark, StudentGrade
from harness.reporting.json_text import json_text
from harness.suite.discovery import UsageError

CLASSROOM50 = "classroom50/result/v1"
IDENTITY = {
    "classroom": "CLASSROOM",
    "assignment": "ASSIGNMENT",
    "submission": "SUBMISSION_TAG",
    "commit": "COMMIT_URL",
    "release": "RELEASE_URL",
    "review": "REVIEW_URL",
}
"""Fields of Classroom 50 and the environment variables that have them."""


def write_gradescope(grade: ClassGrade, file: Path) -> None:
    """Write `results.json` of one submission as Gradescope reads it [1].

    Raises:
        HarnessError: The file cannot be written.

    References:
        [1] gradescope-autograders.readthedocs.io, "Autograder Specifications".
    """
    [student] = grade.students
    _write(file, gradescope(student))


def gradescope(student: StudentGrade) -> dict[str, Any]:
    """Score and tests; without tests where nothing was run."""
    document: dict[str, Any] = {
        "score": student.earned,
        "output": student.problem or student.remark or "every point is earned",
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
    }
    tests = [
        {
            "name": name,
            "score": round(mark.earned, 6),
            "max_score": round(mark.points, 6),
            "status": "failed" if mark.reason else "passed",
            "output": _text(mark, is_hidden=is_hidden),
            "visibility": "visible",
        }
        for name, mark, is_hidden in _marks(student)
    ]
    return {**document, "tests": tests} if tests else document


def write_classroom50(grade: ClassGrade, file: Path, environment: Mapping[str, str]) -> None:
    """Write `result.json` of one submission as Classroom 50 reads it [1].

    Args:
        grade: The grade of a class of one.
        file: Where the runner expects it: `result.json` in the working directory.
        environment: The variables that the runner of Classroom 50 sets.

    Raises:
        UsageError: One of them is missing: the command does not run there.
        HarnessError: The file cannot be written.

    References:
        [1] foundation50/classroom50, wiki/Advanced-Autograding.md.
    """
    [student], hidden = grade.students, grade.assignment.model.hidden
    missing = [
        name for name in IDENTITY.values() if name != "REVIEW_URL" and name not in environment
    ]
    if missing:
        raise UsageError(
            f"--classroom50 needs the environment of its runner: {', '.join(missing)} is not set"
        )
    identity = {field: environment.get(name, "") for field, name in IDENTITY.items()}
    identity["review"] = identity["review"] or identity["commit"]
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    document = {"schema": CLASSROOM50, **identity, "datetime": _handed_in() or now}
    _write(file, {**document, "graded_at": now, **classroom50(student, 1 + len(hidden))})


def classroom50(student: StudentGrade, cases: int) -> dict[str, Any]:
    """Scores as whole numbers, which the format has: in hundredths where points are not whole.

    Args:
        student: The grade of the submission.
        cases: The number of cases, the public one included, so that all submissions count alike.
    """
    marks = list(_marks(student))
    is_whole = all(float(each.points / cases).is_integer() for each in student.criteria)
    unit = 1 if is_whole else 100
    tests = [
        {
            "test-name": name,
            "passed": not mark.reason,
            "score": math.floor(mark.earned * unit + 0.5),
            "max-score": math.floor(mark.points * unit + 0.5),
            "output": _text(mark, is_hidden=is_hidden),
        }
        for name, mark, is_hidden in marks
    ]
    if not tests:
        whole = math.floor(student.points * unit + 0.5)
        tests = [{"test-name": "the submission can be graded", "passed": False, "score": 0}]
        tests[0] |= {"max-score": whole, "output": student.problem}
    total = {key: sum(int(str(each[key])) for each in tests) for key in ("score", "max-score")}
    return {**total, "tests": tests}


def _marks(student: StudentGrade) -> Iterator[tuple[str, Mark, bool]]:
    """Name of a test, its mark, and whether its case is hidden."""
    for run in student.runs:
        for mark in run.marks:
            case = f"hidden case {run.number}: " if run.number else ""
            yield f"{case}{mark.criterion.text}", mark, bool(run.number)


def _text(mark: Mark, *, is_hidden: bool) -> str:
    if is_hidden:
        return f"margin {mark.margin}" if mark.margin else ("not met" if mark.reason else "")
    return mark.reason or (f"margin {mark.margin}" if mark.margin else "")


def _handed_in() -> str:
    """When the graded commit was made, in UTC; empty outside a repository."""
    command = ["git", "log", "-1", "--format=%cI"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        return ""
    moment = datetime.fromisoformat(done.stdout.strip().replace("Z", "+00:00"))
    return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _write(file: Path, document: Mapping[str, Any]) -> None:
    with writing(file.parent), replaced(file) as stream:
        stream.write(json_text(document).encode())
