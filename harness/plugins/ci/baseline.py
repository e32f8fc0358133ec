"""Margins of a suite in a small file, and those that shrank since it was written."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.core.files import is_file, path_exists, replaced, writing
from harness.plugins.ci.document import read_document
from harness.plugins.ci.gate import KEEP
from harness.plugins.ci.suite_reporters.junit import SAMPLE
from harness.recording.verdict import Verdict
from harness.reporting.suite.record import SuiteCase
from harness.suite.discovery import UsageError
from harness.suite.header import read_header

FORMAT = "armharness-margins/1"
DEFAULT_FILE = "margins.json"

Margins = Mapping[str, Mapping[str, float]]
"""Name of a case -> expectation with its unit -> margin."""


@dataclass(frozen=True)
class ShrunkMargin:
    """A margin that is smaller than it may be, or whose expectation is not judged any more.

    Attributes:
        file: The file of the scenario.
        line: The line of the expectation; 0 if unknown.
        case: The name of the case in the baseline.
        expectation: The expectation and the step that it belongs to.
        before: The margin in the baseline, in `unit`.
        now: The margin of this run, in `unit`; NaN where nothing has this expectation any more.
    """

    file: str
    line: int
    case: str
    expectation: str
    before: float
    now: float
    unit: str

    @property
    def is_gone(self) -> bool:
        """Whether the expectation is not judged any more."""
        return math.isnan(self.now)

    @property
    def change(self) -> str:
        """The change in small units: `40 -> 6 mm`."""
        if self.is_gone:
            return f"{self.before:.4g}{'' if self.unit == '1' else f' {self.unit}'} -> gone"
        if self.unit == "m":
            return f"{self.before * 1000:.4g} -> {self.now * 1000:.4g} mm"
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.before:.4g} -> {self.now:.4g}{unit}"

    def __str__(self) -> str:
        if self.is_gone:
            group = self.case.partition(" [")[2].removesuffix("]")
            where = f"in the case '{group}', " if group else ""
            return (
                f"{where}{self.expectation} is expected no more, or in other words: {self.change}"
            )
        return f"the margin of '{self.expectation}' shrank: {self.change}"


def shrunk_margins(
    cases: Sequence[SuiteCase], baseline: Margins, keep: float = KEEP
) -> list[ShrunkMargin]:
    """The margins of passed expectations that lost more than they may, and those that are gone.

    A failed expectation is none of them: its case has failed. What the baseline does not have, or
    had no margin in it, cannot shrink. An expectation is gone where its case passes without it,
    or where its file, or its case in `parametrize`, exists no more; a case that was not selected is
    not.

    Args:
        cases: The cases of this run.
        baseline: The margins of an earlier run.
        keep: The share of each earlier margin that has to remain.
    """
    found: dict[tuple[str, str], ShrunkMargin] = {}
    for name, key, verdict, file in _margins(cases):
        before = baseline.get(name, {}).get(key, 0.0)
        if verdict.status != "passed" or not verdict.margin < keep * before:
            continue
        expectation = _named(verdict)
        shrunk = ShrunkMargin(
            file, verdict.line, name, expectation, before, verdict.margin, verdict.unit
        )
        known = found.setdefault((name, key), shrunk)
        if shrunk.now < known.now:
            found[name, key] = shrunk
    return [*found.values(), *_gone(cases, baseline)]


def _gone(cases: Sequence[SuiteCase], baseline: Margins) -> Iterator[ShrunkMargin]:
    """Expectations of the baseline that are judged no more, though their case was run."""
    judged: dict[str, set[str]] = {}
    for case in cases:
        judged.setdefault(_case_name(case), set()).update(map(_named, case.result.verdicts))
    failed = {_case_name(case) for case in cases if case.result.outcome != "passed"}
    dropped = _dropped(cases, baseline)
    for name, margins in baseline.items():
        file = name.partition(" [")[0]
        is_there = name not in dropped and path_exists(file)
        if name in failed or (name not in judged and is_there):
            continue
        for key, before in margins.items():
            expectation, _, unit = key.rpartition(" [")
            if expectation not in judged.get(name, ()):
                unit = unit.removesuffix("]")
                yield ShrunkMargin(file, 0, name, expectation, before, math.nan, unit)


def _dropped(cases: Sequence[SuiteCase], baseline: Margins) -> set[str]:
    """The cases of the baseline that files of this run have no more; broken files have theirs."""
    files = {case.result.file for case in cases}
    files -= {case.result.file for case in cases if case.result.outcome == "invalid"}
    known = {_case_name(case) for case in cases}
    for file in filter(os.path.isfile, files):
        cases_of_file = read_header(Path(file)).variation.parametrized()
        known |= {_name(file, each.name) for each in cases_of_file}
    return {name for name in baseline if name not in known and name.partition(" [")[0] in files}


def new_margins(cases: Iterable[SuiteCase], baseline: Margins) -> int:
    """The number of expectations with a margin that the baseline does not have."""
    keys = {(name, key) for name, key, verdict, _ in _margins(cases) if verdict.margin > 0}
    return sum(key not in baseline.get(name, {}) for name, key in keys)


def updated(cases: Sequence[SuiteCase], baseline: Margins) -> dict[str, dict[str, float]]:
    """The baseline with the margins of the cases that passed in place of earlier ones.

    Cases that failed or did not run keep their margins; those that are gone are left out.
    """
    passed: dict[str, dict[str, float]] = {}
    failed = {_case_name(case) for case in cases if case.result.outcome != "passed"}
    for name, key, verdict, _ in _margins(cases):
        least = passed.setdefault(name, {}).get(key, math.inf)
        passed[name][key] = min(least, verdict.margin)
    dropped = _dropped(cases, baseline)
    kept = {
        name: dict(margins)
        for name, margins in baseline.items()
        if name not in dropped and is_file(name.partition(" [")[0])
    }
    return kept | {name: margins for name, margins in passed.items() if name not in failed}


def read_baseline(file: Path) -> Margins:
    """The margins in a file.

    Raises:
        UsageError: There is no such file, or it is no baseline.
    """
    document = read_document(file, FORMAT, "--update-baseline writes it")
    try:
        return {
            str(name): {_with_unit(key, text): _number(text) for key, text in margins.items()}
            for name, margins in document["margins"].items()
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(f"'{file}' is no baseline of margins: {error}") from error


def write_baseline(file: Path, margins: Margins) -> None:
    """Write margins, sorted, a line each, so that a review shows what changed.

    Raises:
        HarnessError: The file cannot be written.
    """
    content = {
        name: dict(_text(key, margin) for key, margin in sorted(of_case.items()))
        for name, of_case in sorted(margins.items())
    }
    text = json.dumps({"format": FORMAT, "margins": content}, indent=2, ensure_ascii=False)
    with writing(file.parent), replaced(file) as stream:
        stream.write(f"{text}\n".encode())


def _margins(cases: Iterable[SuiteCase]) -> Iterator[tuple[str, str, Verdict, str]]:
    """Case, key, verdict and file of every verdict with a margin."""
    for case in cases:
        for verdict in case.result.verdicts:
            if math.isfinite(verdict.margin):
                key = f"{_named(verdict)} [{verdict.unit}]"
                yield _case_name(case), key, verdict, case.result.file


def _case_name(case: SuiteCase) -> str:
    """File and case; samples of one case share a name, and the least of their margins counts."""
    return _name(case.result.file, SAMPLE.sub("", case.result.case))


def _name(file: str, group: str) -> str:
    return f"{file} [{group}]" if group else file


def _named(verdict: Verdict) -> str:
    return f"{verdict.step}: {verdict.expectation}" if verdict.step else verdict.expectation


def _text(key: str, margin: float) -> tuple[str, str]:
    """The expectation, and its margin with the unit: `0.04 m`."""
    expectation, _, unit = key.rpartition(" [")
    return expectation, f"{margin:.6g} {unit.removesuffix(']')}"


def _with_unit(expectation: str, text: str) -> str:
    return f"{expectation} [{text.partition(' ')[2]}]"


def _number(text: str) -> float:
    if not re.fullmatch(r"[-+.\de]+ \S+", text) or math.isinf(number := float(text.split()[0])):
        raise ValueError(f"'{text}' is no margin with a unit, such as '0.04 m'")
    return number
