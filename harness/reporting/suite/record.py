"""A suite as plain data: its cases in file order, and the rates of those that are samples."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any
from urllib.parse import quote

from harness.recording.run import Outcome
from harness.recording.verdict import Verdict
from harness.reporting.json_text import compact_json, json_text
from harness.reporting.margins import margin_share, worst
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate
from harness.reporting.suite.cause import Cause, cause_of
from harness.reporting.terminal import failure_place

FORMAT = "armharness-results/1"


def link_from(folder: Path, target: str) -> str:
    """The address of a file, from a page in a folder."""
    return quote(Path(os.path.relpath(Path(target).resolve(), folder.resolve())).as_posix())


@dataclass(frozen=True)
class SuiteCase:
    """A case with what its file says of it.

    Attributes:
        values: What varies, path -> value.
        again: The words of the command that shows it again; None: those of its file and case.
        options: Further words of that command, as `--set`, `lift=0.1`.
    """

    result: CaseResult
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    tags: tuple[str, ...] = ()
    verifies: tuple[str, ...] = ()
    again: tuple[str, ...] | None = None
    options: tuple[str, ...] = ()

    @cached_property
    def nearest(self) -> Verdict | None:
        """The verdict nearest to failing, or farthest beyond; None where none has a margin."""
        return worst(self.result.verdicts)

    @cached_property
    def share(self) -> float:
        """The worst margin as a share of its limit; NaN where there is none."""
        return math.nan if self.nearest is None else margin_share(self.nearest)

    @cached_property
    def cause(self) -> Cause | None:
        return cause_of(self.result)

    def link(self, folder: Path) -> str:
        """The case's page, or its folder, from a page in another folder; empty without one."""
        target = self.result.page or self.result.report_dir
        return link_from(folder, target) if target else ""

    def address(self, folder: Path) -> str:
        """The same, at the first failure."""
        return self.link(folder) + (failure_place(self.result) if self.result.page else "")

    @property
    def urgency(self) -> tuple[bool, float]:
        """Failures first, then what is nearest to failing."""
        return self.result.outcome == "passed", math.inf if math.isnan(self.share) else self.share


@dataclass(frozen=True)
class SuiteRecord:
    """Everything that a suite's files are written from.

    Attributes:
        outcome: The gravest outcome of all.
        cases: The cases in file order; of samples those that count.
        is_interrupted: Whether Ctrl-C ended it early.
        missing_parts: Why a suite that was merged from parts is incomplete, one sentence each.
        title: What the page is called instead of the number of cases that passed.
        failing_changes: What a search found, which a section of a plug-in shows.
        tried: What the search did, a sentence each.
        progress: The number of runs that are done while the suite runs; empty when it has ended.
        wall: Wall time from the first case to the last [s]; 0 where it is not known.
    """

    outcome: Outcome
    cases: Sequence[SuiteCase]
    rates: Sequence[SampledRate] = ()
    is_interrupted: bool = False
    missing_parts: Sequence[str] = ()
    title: str = ""
    failing_changes: Sequence[Any] = ()
    tried: Sequence[str] = ()
    progress: str = ""
    wall: float = 0.0


def results_json(
    record: SuiteRecord, exit_code: int, cases: Iterable[SuiteCase] | None = None
) -> Iterator[str]:
    """What `results.json` and `--json` say, in parts; a case is a line.

    Args:
        cases: The cases of the record, where somebody else reads them too.
    """
    head = {
        "format": FORMAT,
        "exit_code": exit_code,
        "outcome": record.outcome,
        "interrupted": record.is_interrupted,
        "missing_parts": record.missing_parts,
        "rates": record.rates,
    }
    yield json_text(head).removesuffix("\n}\n")
    yield ',\n  "cases": ['
    for index, case in enumerate(record.cases if cases is None else cases):
        yield f"{',' if index else ''}\n{case_json(case)}"
    yield "\n  ]\n}\n"


def case_json(case: SuiteCase) -> str:
    """A case as one line."""
    nearest = case.nearest
    margin = None if nearest is None else {
        "expectation": nearest.expectation,
        "margin": nearest.margin,
        "unit": nearest.unit,
        "share": case.share,
    }  # fmt: skip
    content = {
        name: getattr(case.result, name)
        for name in CaseResult.__dataclass_fields__
        if name != "inputs"
    }
    content |= {"values": case.values, "tags": case.tags, "verifies": case.verifies}
    return compact_json({**content, "worst_margin": margin})
