"""The page of a suite: every row is plain HTML, which a script filters, sorts and groups."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.reporting.html import bundle
from harness.reporting.margins import allowance_used
from harness.reporting.sampled import missed, rate_text, short_value
from harness.reporting.suite.campaign import campaign_of
from harness.reporting.suite.cause import Cause
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.history import Key
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.tables import table_lines
from harness.reporting.terminal import OUTCOMES, Style, failure_place

FOLDER = Path(__file__).with_name("page")
SIGNS = Style(has_signs=True)
MOST_ROWS = 2000
SPARK_WIDTH, SPARK_HEIGHT = 90, 20  # [pixels], as in the template


@dataclass(frozen=True)
class Trend:
    """Worst margins over runs: a small line, and what it shows in words."""

    text: str
    points: str


@dataclass(frozen=True)
class CaseRow:
    """A row of the table of cases.

    Attributes:
        link: The case's page at its first failure, from the suite's page; empty for none.
        share: The worst margin as a share of its limit; 9 where there is none.
        used: The share of the allowance that was used [%]; None where there is no limit.
        drawn: What varies in the case, with its values.
        words: What a search finds it by.
        trend: Worst margins of earlier runs and this one; None where there are too few.
    """

    index: int
    case: SuiteCase
    cause: Cause | None
    link: str
    share: float
    used: float | None
    drawn: str
    words: str
    trend: Trend | None


def suite_html(
    record: SuiteRecord,
    columns: Columns,
    folder: Path,
    history: Mapping[Key, Sequence[float | None]] | None = None,
) -> str:
    """One self-contained page; links to the cases' pages are relative to its folder.

    Args:
        columns: What varies in its cases, with at most `MOST_ROWS` listed.
    """
    total, outcomes = len(record.cases), columns.outcomes
    rows = [_row(i, record.cases[i], folder, history or {}) for i in columns.listed]
    passed = f"{outcomes['passed']} of {total} passed"
    return bundle.rendered(
        FOLDER / "suite.html",
        script=_read("suite.js") + _read("campaign.js"),
        style=bundle.theme() + _read("suite.css"),
        record=record,
        title="; ".join(filter(None, (passed, missed(record.rates)))),
        outcomes=[(name, outcomes[name]) for name in reversed(OUTCOMES) if outcomes[name]],
        causes=columns.causes.most_common(),
        rates=[
            (each, each.rate, rate_text("", each.rate).partition(": ")[2])
            for each in sorted(record.rates, key=lambda each: each.outcome == "passed")
        ],
        campaign=campaign_of(columns, record.cases, folder),
        varied=_varied(columns),
        history=bool(history),
        rows=rows,
        unlisted=total - len(rows),
    )


def _varied(columns: Columns) -> list[str]:
    """A block of lines for each quantity that varies; they flow side by side."""
    blocks: list[str] = []
    for line in table_lines(columns, SIGNS):
        if line.startswith(" "):
            blocks[-1] += f"\n{line}"
        else:
            blocks.append(line)
    return blocks


def _row(
    index: int, case: SuiteCase, folder: Path, history: Mapping[Key, Sequence[float | None]]
) -> CaseRow:
    result, nearest, cause = case.result, case.nearest, case.cause
    earlier = history.get((result.file, result.case), ())
    words = (result.title, result.case, result.file, *case.tags, *case.verifies)
    used = allowance_used(nearest.measures[0]) if nearest and nearest.measures else None
    return CaseRow(
        index,
        case,
        cause,
        case.link(folder) + (failure_place(result) if result.page else ""),
        case.share if math.isfinite(case.share) else 9,
        None if used is None else 100 * used,
        ", ".join(f"{path} {short_value(value)}" for path, value in case.values.items()),
        " ".join([*words, cause.text if cause else ""]).lower(),
        _trend([*earlier, None if nearest is None else case.share]),
    )


def _trend(shares: Sequence[float | None]) -> Trend | None:
    """Worst margins over runs; the middle is where an expectation flips.

    Heights are square roots: what happens near the middle is what matters.
    """
    known = [(index, share) for index, share in enumerate(shares) if share is not None]
    if len(known) < 2:
        return None
    step = SPARK_WIDTH / (len(shares) - 1)
    points = " ".join(
        f"{index * step:.1f},{SPARK_HEIGHT * (1 - _root(share)) / 2:.1f}" for index, share in known
    )
    text = f"worst margin in {len(known)} runs, now {known[-1][1]:.0%} of its limit"
    return Trend(text, points)


def _root(share: float) -> float:
    return math.copysign(math.sqrt(abs(share)), share)


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")
