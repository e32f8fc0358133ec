"""The page of a class, whose script sorts its table, and that of each student."""

from __future__ import annotations

import base64
import math
import os
from bisect import bisect_right
from collections import Counter
from dataclasses import replace
from itertools import count, pairwise
from pathlib import Path
from urllib.parse import quote

from harness.core.files import replaced, writing
from harness.plugins.grading.classroom.results import ClassGrade, Criterion, StudentGrade
from harness.plugins.grading.classroom.run import HIDDEN, RUN, STUDENTS
from harness.plugins.grading.classroom.tables import TABLES
from harness.reporting.html import bundle
from harness.reporting.suite import page as suite_page
from harness.reporting.suite.failure_picture import step_at
from harness.reporting.terminal import causes, failure_place, root_failures

FOLDER = Path(__file__).with_name("page")
PAGE = "index.html"
MOST_PICTURES = 4  # of a submission's page, the failed steps first
LARGEST_PICTURE = 10**6  # [bytes]
FEWEST_BARS, MOST_BARS = 5, 12  # of the distribution of points, but for that of full marks
ROUNDING = 1e-9  # [points]: sums such as 0.1 + 0.2 belong to the bar they begin
FEWEST_DRAWN = 5  # submissions; the points of fewer are read from the table


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


def losses(grade: ClassGrade) -> list[tuple[Criterion, float, Counter[str], list[str]]]:
    """Criteria by lost points, with statuses in the public case and who fails only hidden ones."""
    found: list[tuple[Criterion, float, Counter[str], list[str]]] = []
    for index, criterion in enumerate(grade.criteria):
        lost = sum(criterion.points - s.earned_of(index) for s in grade.students)
        marks = [s.public.marks[index] if s.public else None for s in grade.students]
        unmet = [each and each.verdict for each in marks if not each or each.reason]
        public = Counter(each.status if each else "not run" for each in unmet)
        hidden = [s.submission.name for s in grade.students if index in s.hidden_loss]
        found.append((criterion, round(lost, 6), public, hidden))
    return sorted(found, key=lambda each: -each[1])


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
    names = [each.submission.folder for each in students]
    links = {name: f"{STUDENTS}/{quote(name)}/{PAGE}" for name in names}
    failed_hidden = {each.submission.folder: _failed_hidden(each, folder) for each in students}
    return bundle.rendered(
        FOLDER / "class.html",
        script=bundle.script(FOLDER / "class.js"),
        style=_style(),
        title=grade.assignment.model.assignment,
        made=suite_page.made(),
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
        confinement=grade.confinement,
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
    lost = [each for each in (public.marks if public else ()) if each.verdict and each.reason]
    decided = [
        (step_at(result, each.verdict.time or math.nan), each)  # 0: it never came true
        for each in lost
        if result is not None and each.verdict and not each.holds
    ]
    steps = result.steps if result is not None else ()
    return bundle.rendered(
        FOLDER / "student.html",
        script="",
        style=_style(),
        exercise=grade.assignment.model,
        student=student,
        result=result,
        reasons=causes(replace(result, verdicts=())) if result is not None else [],
        failed_steps=root_failures(steps),
        first=min(lost, key=lambda each: each.holds, default=None),
        decided=decided,
        replay=f"{RUN}/{quote(os.path.relpath(page, own / RUN))}" if page else "",
        place=failure_place(result) if result is not None else "",
        pictures=_pictures(own),
        steps=[each for each in steps if each.status != "not reached"],
    )


def _pictures(own: Path) -> list[tuple[str, str, str]]:
    """Name, address and content of a few pictures: those that explain failures, the last steps."""
    files = sorted(Path(own, RUN, "images").glob("*.jpg"))
    chosen = [each for each in files if each.stem.startswith("finding-")]
    chosen += [each for each in files if each.stem.endswith("-why")]
    chosen += [each for each in reversed(files) if each not in chosen]
    return [
        (
            each.stem,
            quote(each.relative_to(own).as_posix()),
            f"data:image/jpeg;base64,{base64.b64encode(each.read_bytes()).decode()}",
        )
        for each in sorted(chosen[:MOST_PICTURES])
        if not each.is_symlink() and each.stat().st_size < LARGEST_PICTURE
    ]


def _style() -> str:
    suite = (suite_page.FOLDER / "suite.css").read_text(encoding="utf-8")
    return bundle.theme() + suite + (FOLDER / "class.css").read_text(encoding="utf-8")
