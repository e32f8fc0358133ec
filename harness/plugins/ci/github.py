"""What GitHub's actions show: annotations at lines of files, and a summary of the job [1].

References:
    [1] GitHub, "Workflow commands for GitHub Actions".
"""

from __future__ import annotations

import heapq
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from harness.core.errors import HarnessError, Problem
from harness.core.printable import printable, printable_lines
from harness.reporting.result import CaseResult
from harness.reporting.sampled import missed, rate_text
from harness.reporting.suite.cause import cause_of
from harness.reporting.suite.record import SuiteCase, SuiteRecord

MOST_ROWS = 100  # of the table in a summary
SIGNS = {"passed": "✅", "failed": "❌", "invalid": "⛔", "error": "💥"}


def annotation(file: str, line: int, title: str, text: str) -> str:
    """A line that GitHub shows as an error at a line of a file; 0 is no line."""
    return _command(file, line, 0, title, text)


def error_annotations(results: Iterable[CaseResult]) -> Iterator[str]:
    """A line for each thing that went wrong, which GitHub shows at its place in the file."""
    for result in results:
        cause = cause_of(result)
        if result.outcome == "invalid" and result.problems:
            yield from map(problem_annotation, result.problems)
        elif cause is not None:
            yield _command(result.file, cause.line, cause.column, result.name, cause.text)


def append_summary(record: SuiteRecord) -> None:
    """Append to the job's summary, where an action runs: GitHub sets GITHUB_STEP_SUMMARY.

    Raises:
        HarnessError: The summary cannot be written.
    """
    file = os.environ.get("GITHUB_STEP_SUMMARY")
    if file:
        try:
            with Path(file).open("a", encoding="utf-8") as summary:
                summary.write(job_summary(record))
        except OSError as error:
            raise HarnessError(f"'{file}' cannot be written: {error.strerror}") from error


def annotations_for_action(results: Iterable[CaseResult]) -> Iterator[str]:
    """Lines to print where an action runs: GitHub sets GITHUB_ACTIONS; else none."""
    if os.environ.get("GITHUB_ACTIONS") == "true":
        yield from error_annotations(results)


def problem_annotation(problem: Problem) -> str:
    """A mistake in a file, at its place."""
    return _command(problem.path, problem.line, problem.column, "harness", problem.sentence)


def _command(file: str, line: int, column: int, title: str, text: str) -> str:
    place = {"file": file, "line": line, "col": column, "title": title}
    words = ",".join(f"{key}={_property(str(value))}" for key, value in place.items() if value)
    return f"::error {words}::{_data(text)}"


def _data(text: str) -> str:
    return printable_lines(text).replace("%", "%25").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(printable(text)).replace(":", "%3A").replace(",", "%2C")


def job_summary(record: SuiteRecord) -> str:
    """Markdown: the count, a table with the worst first, and the rates of samples."""
    order = heapq.nsmallest(MOST_ROWS, record.cases, key=lambda case: case.urgency)
    more = len(record.cases) - len(order)
    passed = sum(case.result.outcome == "passed" for case in record.cases)
    of = f"{passed} of {len(record.cases)} passed"
    summary = "; ".join(filter(None, (of, missed(record.rates))))
    lines = [f"## {SIGNS[record.outcome]} armharness: {summary}", ""]
    lines += [
        f"- {rate_text(markdown_cell(f'{r.file} {r.group}'.strip()), r.rate)}" for r in record.rates
    ]
    lines += ["", "| | case | nearest to failing | why |", "|---|---|---|---|"]
    lines += map(_row, order)
    lines += ["", f"and {more} more"] if more else []
    return "\n".join(lines) + "\n"


def _row(case: SuiteCase) -> str:
    result, nearest, cause = case.result, case.nearest, case.cause
    margin = ""
    if nearest is not None:
        margin = f"{nearest.expectation}: {nearest.margin:.4g} {nearest.unit}".removesuffix(" 1")
    cells = [SIGNS[result.outcome], result.name, margin, cause.text if cause else ""]
    return f"| {' | '.join(map(markdown_cell, cells))} |"


def markdown_cell(text: str) -> str:
    """Text that stays text in a table of Markdown."""
    text = printable(" ".join(text.split())).replace("\\", "\\\\")
    for sign in "|<>`*_[]":
        text = text.replace(sign, f"\\{sign}")
    return text
