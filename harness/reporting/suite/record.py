"""A suite as plain data: its cases in file order, and the rates of those that are samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.recording.run import Outcome
from harness.reporting.margins import margin_share, worst
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate

FORMAT = "armharness-results/1"


@dataclass(frozen=True)
class SuiteCase:
    """A case with what its file says of it.

    Attributes:
        result: The result of the case.
        values: What varies, path -> value.
        tags: The tags of the file.
        verifies: Requirements that the file names.
    """

    result: CaseResult
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    tags: tuple[str, ...] = ()
    verifies: tuple[str, ...] = ()


@dataclass(frozen=True)
class SuiteRecord:
    """Everything that a suite's files are written from.

    Attributes:
        outcome: The gravest outcome of all.
        cases: The cases in file order; of samples those that count.
        rates: The rates of samples.
        is_interrupted: Whether Ctrl-C ended it early.
        missing_parts: Why a suite that was merged from parts is incomplete, one sentence each.
    """

    outcome: Outcome
    cases: Sequence[SuiteCase]
    rates: Sequence[SampledRate] = ()
    is_interrupted: bool = False
    missing_parts: Sequence[str] = ()


def results_document(record: SuiteRecord, exit_code: int) -> dict[str, object]:
    """What `results.json` and `--json` say."""
    return {
        "format": FORMAT,
        "exit_code": exit_code,
        "outcome": record.outcome,
        "interrupted": record.is_interrupted,
        "missing_parts": list(record.missing_parts),
        "cases": [_case(each) for each in record.cases],
        "rates": list(record.rates),
    }


def _case(case: SuiteCase) -> dict[str, object]:
    said = {name: getattr(case.result, name) for name in CaseResult.__dataclass_fields__}
    nearest = worst(case.result.verdicts)
    margin = None if nearest is None else {
        "expectation": nearest.expectation,
        "margin": nearest.margin,
        "unit": nearest.unit,
        "share": margin_share(nearest),
    }  # fmt: skip
    said |= {"values": case.values, "tags": case.tags, "verifies": case.verifies}
    return {**said, "worst_margin": margin}
