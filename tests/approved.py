"""The facts of verdicts, findings and problems of tests, compared with those that were approved.

A test states what matters in a verdict on a hand-made run, or in a problem of a file.
`approved.txt` has the rest of it: every status, number and measure, and of each text, hint and
warning its numbers and its quoted names, as they were last approved. Words are free to change.
After a change of a fact,

    APPROVE=1 python -m pytest tests/judging tests/session tests/steps

writes the file again, in one process (without `-n`). Read the difference: it shows what changed.
"""

from __future__ import annotations

import os
import re
from functools import cache
from pathlib import Path

import pytest

from harness.core.errors import Problem
from harness.recording.run import Finding
from harness.recording.verdict import Measure, Verdict

FILE = Path(__file__).with_name("approved.txt")
SAID: list[str] = []
"""The texts of the test that runs."""


@pytest.fixture(autouse=True)
def approved_texts(request):
    """Compare the verdicts and problems of a test, unless it is random."""
    SAID.clear()
    yield
    marks = {mark.name for mark in request.node.iter_markers()} - {"parametrize"}
    if marks or hasattr(request.function, "hypothesis"):
        return
    lines = [line.rstrip() for text in SAID for line in text.splitlines()]
    said = "\n".join(filter(None, lines))
    if os.environ.get("APPROVE"):
        _write({**_approved(), request.node.nodeid: said})
    elif request.node.nodeid in _approved():
        assert said == _approved()[request.node.nodeid], f"not as in {FILE.name}: see {__name__}"


def finding_text(finding: Finding) -> str:
    """A finding of a run: when it is, and its numbers."""
    values = ", ".join(
        f"{key} {_number(value) if isinstance(value, float) else value}"
        for key, value in finding.values.items()
    )
    place = f"{finding.kind} of {finding.step or '-'} at {_number(finding.time)} s"
    return f"{place}: {_facts(finding.message)}\n  {values}"


def problem_text(problem: Problem) -> str:
    """A problem of a file: its line and column, its numbers and its quoted names."""
    return f"{problem.line}:{problem.column} {_facts(problem.message)}\n  {_facts(problem.hint)}"


def verdict_text(verdict: Verdict) -> str:
    """A verdict: its status, its numbers and its measures."""
    observed = verdict.observed
    counts = "" if observed is None else f", {observed.samples} samples"
    if observed is not None:
        counts += f", {observed.unknown} unknown" if observed.unknown else ""
        counts += "" if observed.pairs is None else f", {observed.pairs} pairs"
        counts += "" if observed.premises is None else f", {observed.premises} premises"
    lines = [
        f"{verdict.expectation}",
        f"  {verdict.status} by {_number(verdict.margin)} {verdict.unit or '-'}"
        f" at {_number(verdict.time)} s{counts}: {_facts(verdict.reason)}",
        *(f"    {_measure_text(measure)}" for measure in verdict.measures),
        *(f"    warning {warning.name}: {_facts(warning.message)}" for warning in verdict.warnings),
    ]
    return "\n".join(lines)


def _facts(text: str) -> str:
    """The numbers and the quoted names of a text, in their order."""
    return " ".join(re.findall(r"'[^']*'|-?\d+(?:\.\d+)?", text or ""))


def _measure_text(measure: Measure) -> str:
    parts = [
        f"{measure.name}: {_number(measure.value)} {measure.comparison} {_number(measure.limit)}",
        f"{measure.unit} at {_number(measure.time)} s",
        measure.detail and f"of {measure.detail}",
        measure.ceiling != float("inf") and f"up to {_number(measure.ceiling)}",
        measure.plot and f"in plot {measure.plot}",
        measure.expected and f"expected at {' '.join(map(_number, measure.expected))}",
        measure.actual and f"is at {' '.join(map(_number, measure.actual))}",
    ]
    return ", ".join(part for part in parts if part)


def _number(value: float) -> str:
    return f"{0.0 if abs(value) < 1e-12 else value:.6g}"


@cache
def _approved() -> dict[str, str]:
    if not FILE.exists():
        return {}
    tests = FILE.read_text(encoding="utf-8").rstrip("\n").split("\n\n")
    return dict(test.split("\n", 1) for test in tests)


def _write(approved: dict[str, str]) -> None:
    tests = [f"{test}\n{said}" for test, said in sorted(approved.items()) if said]
    FILE.write_text("\n\n".join(tests) + "\n", encoding="utf-8")
    _approved.cache_clear()
