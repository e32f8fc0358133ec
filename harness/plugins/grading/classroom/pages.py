"""The page of a class and that of each student, static and without scripts."""

from __future__ import annotations

import base64
import os
from bisect import bisect_right
from collections import Counter
from dataclasses import dataclass, replace
from itertools import count, pairwise
from pathlib import Path
from urllib.parse import quote

from harness.core.files import replaced, writing
from harness.plugins.grading.classroom.results import ClassGrade, Criterion, StudentGrade
from harness.plugins.grading.classroom.run import HIDDEN, RUN, STUDENTS
from harness.plugins.grading.classroom.tables import TABLES
from harness.reporting.html import bundle
from harness.reporting.result import CaseResult
from harness.reporting.suite import page as suite_page
from harness.reporting.terminal import causes, failure_place

FOLDER = Path(__file__).with_name("page")
PAGE = "index.html"
MOST_PICTURES = 4  # of a submission's page, the failed steps first
LARGEST_PICTURE = 10**6  # [bytes]
FEWEST_BARS, MOST_BARS = 5, 12  # of the distribution of points, but for that of full marks
ROUNDING = 1e-9  # [points]: sums such as 0.1 + 0.2 belong to the bar they begin
FEWEST_DRAWN = 5  # submissions; the points of fewer are read from the table

PROTECTS = {
    "user": "Each program ran as a user of its own, in a copy of its submission: it can change"
    " nothing of other submissions, results or pages, and read what every user of this machine can."
    " Folders of assignments, submissions and grades that only their owner can enter are hidden.",
    "process": "Each program ran as the user who graded, in a copy of its submission: a program"
    " that is written to harm can read and change what this user can. Start the command as root in"
    " a container, with a Python that all users can read, to prevent that.",
}
"""What keeps programs of students apart, by how they ran."""


@dataclass(frozen=True)
class Loss:
    """What a criterion cost the class.

    Attributes:
        lost: Points of all submissions.
        share: The share of its points that were lost.
        public: The number of submissions that fail it in the public case.
        hidden: Names of those that pass it there and fail a hidden case.
    """

    criterion: Criterion
    lost: float
    share: float
    public: int
    hidden: tuple[str, ...]


def write_pages(grade: ClassGrade, folder: Path) -> Path:
    """Write the pages of students and class below a folder, after all programs have ended.

    Returns:
        The page of the class.

    Raises:
        HarnessError: A file cannot be written.
    """
    for student in grade.students:
        own = folder / STUDENTS / student.submission.folder
        with writing(own), replaced(own / PAGE) as file:
            file.write(_student_html(grade, student, own).encode())
    with writing(folder), replaced(folder / PAGE) as file:
        file.write(_class_html(grade, folder).encode())
    return folder / PAGE


def losses(grade: ClassGrade) -> list[Loss]:
    """What each criterion cost the class, the most expensive first."""
    found: list[Loss] = []
    for index, criterion in enumerate(grade.criteria):
        lost, public, hidden = 0.0, 0, list[str]()
        for student in grade.students:
            lost += criterion.points - (student.earned_of(index) if student.runs else 0.0)
            public += student.public is None or bool(student.public.marks[index].reason)
            if index in student.hidden_loss:
                hidden.append(student.submission.name)
        share = lost / (criterion.points * len(grade.students)) if criterion.points else 0.0
        found.append(Loss(criterion, round(lost, 6), share, public, tuple(hidden)))
    return sorted(found, key=lambda each: -each.lost)


def distribution(grade: ClassGrade) -> list[tuple[float, float, int]]:
    """The least points of each bar and of the next one, and its number of submissions.

    A bar is 1, 2, 5, ... points wide, or such a decimal; full marks are the last one.
    """
    points = sum(each.points for each in grade.criteria)
    first = 0 if points >= FEWEST_BARS else -2
    widths = (digit * 10.0**power for power in count(first) for digit in (1, 2, 5))
    width = next(each for each in widths if points <= MOST_BARS * each)
    inner = (place * width for place in range(MOST_BARS))
    ends = [*(each for each in inner if each < points - ROUNDING), points]
    counts = Counter(bisect_right(ends, each.earned + ROUNDING) - 1 for each in grade.students)
    return [(low, high, counts[i]) for i, (low, high) in enumerate(pairwise([*ends, points]))]


def _class_html(grade: ClassGrade, folder: Path) -> str:
    students, cases = grade.students, len(grade.assignment.model.hidden)
    links = {
        each.submission.folder: f"{STUDENTS}/{quote(each.submission.folder)}/{PAGE}"
        for each in students
    }
    failed_hidden = {each.submission.folder: _failed_hidden(each, folder) for each in students}
    return bundle.rendered(
        FOLDER / "class.html",
        script="",
        style=_style(),
        title=grade.assignment.model.assignment,
        students=students,
        links=links,
        failed_hidden=failed_hidden,
        points=sum(each.points for each in grade.criteria),
        mean=sum(each.earned for each in students) / len(students),
        full=sum(each.is_full for each in students),
        losses=losses(grade),
        distribution=distribution(grade) if len(students) >= FEWEST_DRAWN else [],
        cases=cases,
        tables=TABLES,
        protects=PROTECTS[grade.confinement],
        runs_programs=grade.assignment.model.kind in ("node", "ik"),
    )


def _failed_hidden(student: StudentGrade, folder: Path) -> list[tuple[int, str]]:
    """Numbers of the hidden cases that cost points, with the report of each that has one."""
    own = Path(HIDDEN, student.submission.folder)
    failed = [run.number for run in student.runs[1:] if any(mark.reason for mark in run.marks)]
    pages = {number: own / str(number) / "report.html" for number in failed}
    return [
        (number, quote(str(page)) if (folder / page).is_file() else "")
        for number, page in pages.items()
    ]


def _student_html(grade: ClassGrade, student: StudentGrade, own: Path) -> str:
    public = student.public
    result = public.result if public is not None else None
    page = Path(result.page) if result is not None and result.page else None
    return bundle.rendered(
        FOLDER / "student.html",
        script="",
        style=_style(),
        title=grade.assignment.model.assignment,
        description=grade.assignment.model.description,
        student=student,
        result=result,
        reasons=_reasons(result) if result is not None else [],
        replay=f"{RUN}/{quote(os.path.relpath(page, own / RUN))}" if page else "",
        place=failure_place(result) if result is not None else "",
        pictures=_pictures(own / RUN / "images"),
    )


def _reasons(result: CaseResult) -> list[str]:
    """Why a case did not run to its end; verdicts stand in the table of points."""
    failed_steps = any(step.status == "failed" for step in result.steps)
    is_broken = result.outcome in ("error", "invalid")
    return causes(replace(result, verdicts=())) if failed_steps or is_broken else []


def _pictures(folder: Path) -> list[tuple[str, str]]:
    """Name and content of a few pictures: those that explain failures, then the last steps."""
    files = sorted(folder.glob("*.jpg"))
    chosen = [each for each in files if each.stem.startswith("finding-")]
    chosen += [each for each in files if each.stem.endswith("-why")]
    chosen += [each for each in reversed(files) if each not in chosen]
    return [
        (each.stem, f"data:image/jpeg;base64,{base64.b64encode(each.read_bytes()).decode()}")
        for each in sorted(chosen[:MOST_PICTURES])
        if not each.is_symlink() and each.stat().st_size < LARGEST_PICTURE
    ]


def _style() -> str:
    suite = (suite_page.FOLDER / "suite.css").read_text(encoding="utf-8")
    return bundle.theme() + suite + (FOLDER / "class.css").read_text(encoding="utf-8")
