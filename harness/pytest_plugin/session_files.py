"""The files that a pytest session writes about its scenarios, and warnings on small margins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from harness.core.errors import HarnessError
from harness.recording.plain import from_plain, to_plain
from harness.recording.run import Outcome
from harness.reporting.margins import SMALL, margin_share
from harness.reporting.sampled import SampledRate
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.suite.outcome import EXIT_CODES

CACHED = "armharness/margins"
MOST_LINES = 5  # of changed margins below a session; the rest is counted


@dataclass(frozen=True)
class ItemRecord:
    """The results of one item; xdist's workers send it to the controller as plain data.

    Attributes:
        number: Position of the item in its file, from 0.
        cases: One case, or all samples that count; never empty.
    """

    name: str
    number: int
    cases: tuple[SuiteCase, ...]
    rates: tuple[SampledRate, ...] = ()

    @property
    def outcomes(self) -> list[Outcome]:
        """Outcomes of the cases; for samples, of the rates and of invalid or broken samples."""
        rates: list[Outcome] = [each.outcome for each in self.rates]
        cases: list[Outcome] = [case.result.outcome for case in self.cases]
        return rates + [each for each in cases if not self.rates or each in ("invalid", "error")]


def as_plain(record: ItemRecord) -> Any:
    """The record as data that a test report can carry."""
    return to_plain(record)


def from_plains(plains: Sequence[Any]) -> list[ItemRecord]:
    """Records of a session in file order, independent of worker and time."""
    records = [from_plain(each, ItemRecord) for each in plains]
    return sorted(records, key=lambda each: (each.cases[0].result.file, each.number))


def suite_of(records: Sequence[ItemRecord]) -> SuiteRecord:
    """The session's scenarios as one suite."""
    outcomes: list[Outcome] = [outcome for each in records for outcome in each.outcomes]
    return SuiteRecord(
        max(outcomes, key=EXIT_CODES.__getitem__),
        [case for each in records for case in each.cases],
        [rate for each in records for rate in each.rates],
    )


def write_session_files(folder: Path, suite: SuiteRecord, history: Path | None) -> str:
    """Write `index.html`, `junit.xml` and `results.json` if there is more than one case.

    Args:
        history: A folder of earlier results, whose margins the page shows.

    Returns:
        A line with the path of the page, or with the reason why it could not be written; empty
        for one case.
    """
    from harness.reporting.suite.history import history_of
    from harness.reporting.suite.write import write_suite

    if len(suite.cases) < 2:
        return ""
    earlier = history_of(history) if history else {}
    try:
        page, _ = write_suite(folder, suite, EXIT_CODES[suite.outcome], earlier)
    except HarnessError as error:
        return f"no page of the suite: {error}"
    return f"reports: {page}"


def small_margins(records: Sequence[ItemRecord], cache: pytest.Cache | None) -> list[str]:
    """Lines on expectations that barely hold, with their margins in the previous session.

    Args:
        cache: Keeps margins until the next session; None when pytest runs without its cache.
    """
    known: Mapping[str, Mapping[str, float]] = (cache.get(CACHED, None) if cache else None) or {}
    now = {each.name: _shares(each) for each in records}
    if cache:
        cache.set(CACHED, {**known, **now})
    small = sorted(
        (share, text, name)
        for name, shares in now.items()
        for text, share in shares.items()
        if share < SMALL
    )
    last = {(name, text): known.get(name, {}).get(text) for _, text, name in small}
    news = [each for each in small if not _is_known(each[0], last[each[2], each[1]])]
    lines = [_line(*each, last[each[2], each[1]]) for each in news[:MOST_LINES]]
    if len(news) > MOST_LINES:
        lines.append(f"... and {len(news) - MOST_LINES} more")
    if len(small) > len(news):
        lines.append(f"{len(small) - len(news)} below {SMALL:.0%} as they were last time")
    return lines


def _shares(record: ItemRecord) -> dict[str, float]:
    """Smallest margin of each expectation that held, as a share of its limit."""
    found: dict[str, float] = {}
    for case in record.cases:
        for verdict in case.result.verdicts:
            share = margin_share(verdict)
            if verdict.status == "passed" and not math.isnan(share):
                found[verdict.expectation] = min(share, found.get(verdict.expectation, 1.0))
    return found


def _is_known(share: float, last: float | None) -> bool:
    return last is not None and share > last - 1e-6


def _line(share: float, text: str, name: str, last: float | None) -> str:
    before = "" if last is None else f", was {last:.1%} last time"
    return f"holds by {share:.1%} of its limit{before}: {text} ({name})"
