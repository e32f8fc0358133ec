"""Grades all submissions of a class, each case in a process of its own."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.plugins.grading.assignment import HiddenCase, LoadedAssignment
from harness.plugins.grading.classroom.cases import GradedCase, run_graded_case
from harness.plugins.grading.classroom.confined import (
    FIRST_USER,
    adopted_orphans,
    children,
    end_children,
    may_change_user,
)
from harness.plugins.grading.classroom.results import (
    ClassGrade,
    StudentGrade,
    criteria_of,
    graded_run,
)
from harness.plugins.grading.classroom.submissions import (
    Submission,
    SubmissionError,
    main_file,
    remove,
    unpack,
)
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.cases import read_ahead, run_isolated
from harness.suite.header import read_header
from harness.suite.server import preload
from harness.suite.warm import REPORT_MODULES, RUN_MODULES, WarmServer

STUDENTS, HIDDEN, RUN = "students", "hidden", "run"

OnResult = Callable[[str, int, CaseResult], None]
"""Called with the submission's folder, the number of the case and its result."""


def grade_class(
    loaded: LoadedAssignment,
    submissions: Sequence[Submission],
    folder: Path,
    workers: int = 1,
    on_result: OnResult = lambda *_: None,
) -> ClassGrade:
    """Run every case of every submission, and count the points.

    Args:
        folder: Gets the reports of the runs: the public ones in `students`, which may be handed
            to the students, the hidden ones that failed in `hidden`.
        workers: The number of cases that run at the same time.

    Raises:
        SpecError: The assignment's scenario has mistakes, or cases or points that do not fit.
    """
    criteria_of(loaded, ())
    _refuse_several_cases(loaded)
    _refuse_wrong_hidden_cases(loaded)
    runs_programs = loaded.model.kind in ("node", "ik")
    changes_user = runs_programs and may_change_user()
    problems: dict[int, str] = {}
    cases: list[GradedCase] = []
    with _scratch() as scratch:
        for index, each in enumerate(submissions):
            try:
                cases += _cases(loaded, each, scratch, folder, copies=runs_programs)
            except SubmissionError as error:
                problems[index] = str(error)
        if changes_user:
            cases = [replace(case, user=FIRST_USER + i) for i, case in enumerate(cases)]
        results = _results(loaded, cases, workers, on_result)
    criteria = criteria_of(loaded, list(results.values()))
    count = 1 + len(loaded.model.hidden)
    students: list[StudentGrade] = []
    for index, each in enumerate(submissions):
        runs = [
            graded_run(number, results[each.folder, number], criteria, count)
            for number in (range(count) if index not in problems else ())
        ]
        students.append(StudentGrade(each, criteria, tuple(runs), problems.get(index, "")))
    return ClassGrade(loaded, tuple(students), "user" if changes_user else "process")


@contextmanager
def _scratch() -> Iterator[Path]:
    """A folder for copies of submissions, that other users can pass through and not list."""
    folder = Path(tempfile.mkdtemp(prefix="harness-class-"))
    folder.chmod(0o711)
    try:
        yield folder
    finally:
        remove(folder)


def _refuse_several_cases(loaded: LoadedAssignment) -> None:
    """Refuse a scenario with `parametrize` or `randomize`.

    Raises:
        SpecError: It has several cases.
    """
    if loaded.scenario is None:
        return
    if read_header(loaded.scenario).variation.count != 1:
        message = "the scenario has several cases; a graded one has one"
        hint = "list the others under `hidden` of the assignment"
        raise SpecError([Problem(str(loaded.scenario), 0, 0, message, hint)])


def _refuse_wrong_hidden_cases(loaded: LoadedAssignment) -> None:
    """Refuse hidden cases that no submission could pass, since the scenario cannot be changed so.

    Raises:
        SpecError: A path, a value or a robot of a hidden case is wrong.
    """
    if loaded.scenario is None or loaded.lines is None or not loaded.model.hidden:
        return
    known = {each.message for each in _mistakes(loaded.scenario, {})}
    problems = [
        loaded.lines.problem(
            ("hidden", index), f"hidden case {index + 1}: {each.message}", each.hint
        )
        for index, hidden in enumerate(loaded.model.hidden)
        for each in _mistakes(loaded.scenario, _overrides(loaded, hidden))
        if each.message not in known
    ]
    if problems:
        raise SpecError(problems)


def _mistakes(scenario: Path, overrides: dict[str, str]) -> Sequence[Problem]:
    from harness.session.prepare import prepare

    try:
        prepare(scenario, overrides)
    except SpecError as error:
        return error.problems
    return ()


def _cases(
    loaded: LoadedAssignment, submission: Submission, scratch: Path, folder: Path, *, copies: bool
) -> Iterator[GradedCase]:
    """The public case of a submission and the hidden ones.

    Args:
        copies: Whether each case has a copy of the submission to itself, as programs write there.

    Raises:
        SubmissionError: The submission cannot be used.
    """
    limits = loaded.model.limits
    place = scratch / f"{submission.folder}-0"
    main = main_file(unpack(submission, place, limits.files), loaded.model)
    for number, hidden in enumerate([None, *loaded.model.hidden]):
        if number and copies:
            place = scratch / f"{submission.folder}-{number}"
            main = main_file(unpack(submission, place, limits.files), loaded.model)
        report = folder / STUDENTS / submission.folder / RUN
        if number:
            report = folder / HIDDEN / submission.folder / str(number)
        yield GradedCase(
            loaded.scenario or main,
            _overrides(loaded, hidden),
            hidden.seed if hidden is not None else None,
            report_dir=report,
            stills=not number,
            only_failed=bool(number),
            case=f"hidden {number}" if number else "",
            longest=limits.simulated_time,
            assignment=loaded,
            owner=submission.folder,
            main=main,
            scratch=place,
            number=number,
        )


def _overrides(loaded: LoadedAssignment, hidden: HiddenCase | None) -> dict[str, str]:
    """What a hidden case changes in the scenario, as `--set` takes it."""
    if hidden is None or loaded.scenario is None:
        return {}
    found = {path: json.dumps(value) for path, value in hidden.set.items()}
    return found if hidden.robot is None else {"robot.model": json.dumps(hidden.robot), **found}


def _results(
    loaded: LoadedAssignment, cases: Sequence[GradedCase], workers: int, on_result: OnResult
) -> dict[tuple[str, int], CaseResult]:
    """Run the cases; results come through pipes, so that no file of a submission is one."""
    found: dict[tuple[str, int], CaseResult] = {}
    cap = loaded.model.limits.wall_time
    modules = [*RUN_MODULES, "harness.plugins.grading.classroom.cases"]
    with adopted_orphans(), WarmServer(modules) as server:
        if loaded.scenario is not None:
            server.prepare(read_ahead, (), [RunRequest(loaded.scenario)])
            server.prepare(preload, REPORT_MODULES)
        others = children()
        for index, result in run_isolated(
            cases, server, workers=workers, hard_cap=cap, function=run_graded_case
        ):
            end_children({*others, *([server.pid] if server.pid is not None else [])})
            owner, number = cases[index].owner, cases[index].number
            found[owner, number] = result
            on_result(owner, number, result)
    return found
