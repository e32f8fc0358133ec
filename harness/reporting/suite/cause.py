"""Why a case did not pass, in few words: what failures of many cases are grouped by."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from harness.core.errors import Problem
from harness.reporting.result import CaseResult
from harness.reporting.terminal import root_failures

LONGEST = 160  # characters of a message by which failures are grouped: a line of the page


@dataclass(frozen=True)
class Cause:
    """The first thing that went wrong, at its root.

    Attributes:
        group: The same for cases that failed alike: `NO_IK_SOLUTION in move_to`.
        said: Everything that is known of this one, in a line.
        line: The line in the scenario file, from 1; 0 if unknown.
    """

    group: str
    text: str
    line: int = 0
    column: int = 0


def cause_of(result: CaseResult) -> Cause | None:
    """The cause why a case did not pass; None when it passed."""
    if result.outcome == "passed":
        return None
    if result.outcome == "error":
        last = (result.message.strip().splitlines() or ["no cause was reported"])[-1]
        return Cause(f"error: {_short(last)}", last)
    if result.outcome == "invalid":
        for problem in result.problems:
            group = f"invalid: {_short(problem.message)}"
            return Cause(group, problem.sentence, problem.line, problem.column)
        return Cause("invalid", result.message)
    for step in root_failures(result.steps):
        text = ": ".join(filter(None, (step.summary, step.error_code, step.message)))
        return Cause(f"{step.error_code or 'failed'} in {step.verb}", text, step.line)
    for verdict in result.verdicts:
        if verdict.status != "passed":
            said = [verdict.expectation, verdict.status, verdict.reason]
            if verdict.status == "failed" and verdict.reason:
                said.remove("failed")
            text = ": ".join(filter(None, said))
            return Cause(f"{verdict.status}: {verdict.expectation}", text, verdict.line)
    return Cause("failed", result.message or "no cause was reported")


def short_lines(results: Iterable[CaseResult]) -> Iterator[str]:
    """`file:line:column: what went wrong`, as editors and ruff have it."""
    for result in results:
        if result.outcome == "invalid" and result.problems:
            yield from map(short_problem, result.problems)
            continue
        cause = cause_of(result)
        if cause is not None:
            place = f"{result.file}:{cause.line}:1" if cause.line else result.file
            name = f" [{result.case}]" if result.case else ""
            yield f"{place}:{name} {' '.join(cause.text.split())}"


def short_problem(problem: Problem) -> str:
    """A mistake in a file in one line."""
    place = f"{problem.path}:{problem.line}:{problem.column}" if problem.line else problem.path
    return f"{place}: {' '.join(problem.sentence.split())}"


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
