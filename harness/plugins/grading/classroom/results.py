"""Points and reasons of a class, as plain data for pages, tables and grading systems."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import cast

from harness.core.amounts import stated_amount
from harness.core.errors import Problem, SpecError
from harness.judging.expectation import Expectation
from harness.judging.placed import describe
from harness.language.expectation import ExpectationFields
from harness.language.files.source import Source
from harness.language.files.yaml_file import parse_yaml
from harness.language.reading.load import load_scenario
from harness.plugins.grading.assignment import LoadedAssignment
from harness.plugins.grading.classroom.submissions import Submission
from harness.plugins.grading.credit import FULL, GradedResult
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult
from harness.reporting.terminal import causes, root_failures, verdict_line

LONGEST_REASON = 2000  # characters


@dataclass(frozen=True)
class Criterion:
    """What earns points.

    Attributes:
        text: The expectation in the file's words.
        points: The points of all cases together.
        advice: What a student can do where it does not hold; empty where nothing general is known.
    """

    text: str
    points: float
    advice: str = ""


@dataclass(frozen=True)
class Mark:
    """A criterion in one case.

    Attributes:
        verdict: None where the case has none: it did not run to its end.
        points: The points of this case.
        reason: Why they were not earned, or not all of them; empty where they were.
        share: The share of the points that is earned.
    """

    criterion: Criterion
    verdict: Verdict | None
    points: float
    reason: str
    share: float

    @property
    def earned(self) -> float:
        """The points that were earned."""
        return self.points * self.share

    @property
    def holds(self) -> bool:
        """Whether the criterion is met, whatever it earns."""
        return self.verdict is not None and self.verdict.status == "passed"

    @property
    def margin(self) -> str:
        """The margin with its unit; empty where there is none."""
        verdict = self.verdict
        if verdict is None or math.isnan(verdict.margin):
            return ""
        sign = "+" if verdict.margin >= 0 else ""
        return f"{sign}{stated_amount(verdict.margin, verdict.unit)}"


@dataclass(frozen=True)
class GradedRun:
    """One case of a submission.

    Attributes:
        number: 0 for the public case, from 1 for the hidden ones.
        marks: One for each criterion.
    """

    number: int
    result: CaseResult
    marks: tuple[Mark, ...]


@dataclass(frozen=True)
class StudentGrade:
    """The grade of one submission.

    Attributes:
        problem: Why nothing of it could be run; empty where something was.
        person: What a roster says of the student, by column.
    """

    submission: Submission
    criteria: tuple[Criterion, ...]
    runs: tuple[GradedRun, ...]
    problem: str = ""
    person: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def points(self) -> float:
        """Points that can be earned."""
        return sum(each.points for each in self.criteria)

    @property
    def earned(self) -> float:
        """Points that are earned, without the last digits of sums."""
        return round(sum(mark.earned for run in self.runs for mark in run.marks), 6)

    @property
    def is_full(self) -> bool:
        """Whether every point is earned."""
        return bool(self.runs) and all(not mark.reason for run in self.runs for mark in run.marks)

    def marks(self, index: int) -> list[Mark]:
        """The marks of a criterion, of all cases."""
        return [run.marks[index] for run in self.runs]

    def earned_of(self, index: int) -> float:
        """The points that were earned of a criterion."""
        return round(sum(mark.earned for mark in self.marks(index)), 6)

    def holds(self, index: int) -> bool:
        """Whether a criterion is met in every case."""
        return bool(self.runs) and not any(mark.reason for mark in self.marks(index))

    @property
    def public(self) -> GradedRun | None:
        """The case that the student sees; None where nothing was run."""
        return self.runs[0] if self.runs else None

    @property
    def hidden_loss(self) -> list[int]:
        """Indices of the criteria that hold in the public case and not in every hidden one."""
        return [
            index
            for index in range(len(self.criteria) if self.runs else 0)
            if not self.runs[0].marks[index].reason
            and any(run.marks[index].reason for run in self.runs[1:])
        ]

    @property
    def remark(self) -> str:
        """The first reason for lost points, in one line; empty where there is none."""
        if self.problem:
            return self.problem.splitlines()[0]
        for run in self.runs:
            every = [mark for mark in run.marks if mark.reason and mark.points]
            lost = min(every, key=lambda mark: mark.holds, default=None)
            if lost is not None and run.number:
                return f"hidden case {run.number}: {lost.criterion.text}"
            if lost is not None:
                failed = [
                    f"{step.summary}: {step.error_code}: {step.message}"
                    for step in root_failures(run.result.steps)
                ]
                named = f"{lost.criterion.text}: {lost.reason}" if lost.verdict else lost.reason
                return (failed or [named])[0].splitlines()[0]
        return ""


@dataclass(frozen=True)
class ClassGrade:
    """The grades of a class.

    Attributes:
        confinement: What kept the submissions apart: `user` or `process`.
    """

    assignment: LoadedAssignment
    students: tuple[StudentGrade, ...]
    confinement: str

    @cached_property
    def criteria(self) -> tuple[Criterion, ...]:
        """What earns points; that of every submission."""
        return max((each.criteria for each in self.students), key=len)


def criteria_of(loaded: LoadedAssignment, results: Sequence[CaseResult]) -> tuple[Criterion, ...]:
    """What earns points, in file order; of a function, what any of its tests tried.

    Raises:
        SpecError: A step's expectation has points, which a student's steps do not have; or nothing
            has any.
    """
    if loaded.scenario is None:
        worth = {v.expectation: v.points or 0.0 for result in results for v in result.verdicts}
        worth = worth or {"the function can be called": 1.0}
        return _scaled([(text, points, "") for text, points in worth.items()], loaded.model.points)
    read = load_scenario(loaded.scenario)
    scenario = read.scenario
    for index, step in enumerate(scenario.steps):
        for place, each in enumerate(step.expect):
            if each.points and loaded.model.kind == "scenario":
                message = "points of a step are lost where students write the steps"
                hint = "move it to `expect` of the file, and name the step with `during`"
                raise SpecError(
                    [read.lines.problem(("steps", index, "expect", place), message, hint)]
                )
    has_points = any(each.points is not None for each in scenario.expect)
    rows = [
        (each.name or text, (each.points or 0.0) if has_points else 1.0, _advice(each))
        for each, text in zip(scenario.expect, _texts(scenario.expect, results), strict=True)
    ]
    if not sum(points for _, points, _ in rows):
        problem = Problem(str(loaded.scenario), 0, 0, "no expectation of the file has points")
        raise SpecError([problem])
    whole = scenario.points if not has_points else None
    return _scaled(rows, loaded.model.points or whole)


def _texts(
    expectations: Sequence[ExpectationFields], results: Sequence[CaseResult]
) -> Sequence[str]:
    """The texts of expectations: of their verdicts, where the units of joints are known."""
    judged = ([v.expectation for v in each.verdicts if not v.step] for each in results)
    whole = (texts for texts in judged if len(texts) == len(expectations))
    return next(whole, None) or [describe(each) for each in expectations]


@cache
def advice() -> Mapping[str, str]:
    """What a student can do, by the word of an expectation, or `never` and the word within it."""
    text = Path(__file__).with_name("advice.yaml").read_text(encoding="utf-8")
    return cast("Mapping[str, str]", parse_yaml(text, Source.of_text("", text)).plain())


def _advice(expectation: ExpectationFields) -> str:
    inner = expectation.predicates() if isinstance(expectation, Expectation) else {}
    words = [each.word for each in inner.values()] or [expectation.word]
    return advice().get(f"never {words[0]}" if expectation.word == "never" else words[0], "")


def _scaled(rows: Sequence[tuple[str, float, str]], whole: float | None) -> tuple[Criterion, ...]:
    total = sum(points for _, points, _ in rows)
    factor = 1.0 if whole is None else whole / total
    return tuple(Criterion(text, points * factor, hint) for text, points, hint in rows)


def graded_run(
    number: int, result: CaseResult, criteria: Sequence[Criterion], count: int
) -> GradedRun:
    """A case with its points.

    Args:
        number: 0 for the public case.
        result: Its verdicts on the whole run are in the order of the criteria, or there are none.
        criteria: The criteria that earn points, in file order.
        count: The number of cases, among which points are shared equally.
    """
    verdicts = [each for each in result.verdicts if not each.step]
    is_whole = len(verdicts) == len(criteria) and result.outcome in ("passed", "failed")
    credit = result.credit if isinstance(result, GradedResult) else FULL
    marks: list[Mark] = []
    for index, each in enumerate(criteria):
        verdict = verdicts[index] if is_whole else None
        if verdict is not None and verdict.status == "passed":
            share, reason = credit.share, credit.reason and f"it holds, and {credit.reason}"
        else:
            share, reason = 0.0, _why(result, verdict)
        marks.append(Mark(each, verdict, each.points / count, reason, share))
    return GradedRun(number, result, tuple(marks))


def _why(result: CaseResult, verdict: Verdict | None) -> str:
    if verdict is not None:
        return verdict_line(verdict)[:LONGEST_REASON]
    return "\n".join(causes(result))[:LONGEST_REASON] or result.outcome
