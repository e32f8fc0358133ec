"""Success rates of samples, and how they depend on what varies, as lines for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from harness.core.quantity import split_quantity
from harness.recording.run import Outcome
from harness.reporting.result import CaseResult
from harness.reporting.terminal import PLAIN, Style

RateVerdict = Literal["shown", "refuted", "open"]

BINS = 4
"""Parts of equal size into which numbers are cut for a table."""

MOST_ROWS = 12


@dataclass(frozen=True)
class SuccessRate:
    """How many samples passed, and what that shows.

    Attributes:
        passed: The number of `total` that passed.
        total: Samples that count: up to where the sequential test ended the sampling.
        low: Lower end of Wilson's interval.
        high: The upper end of the interval.
        confidence: The confidence of the interval.
        at_least: Required rate; None when the file requires none.
        verdict: `shown` when the rate is at least the required one, `refuted` when not, `open`
            when these samples do not decide.
        stopped_early: Whether the sequential test ended the sampling.
        overlapping: Samples that were run although objects overlap at their start.
        redrawn: Samples that were drawn again because objects overlapped.
        redraws: How often, of all of them together.
        invalid: Samples that could not be run; they are not in `total`.
        is_one_run: Whether all samples have one digest: they are one run, and show no rate.
    """

    passed: int
    total: int
    low: float
    high: float
    confidence: float
    at_least: float | None
    verdict: RateVerdict
    stopped_early: bool = False
    overlapping: int = 0
    redrawn: int = 0
    redraws: int = 0
    invalid: int = 0
    is_one_run: bool = False


@dataclass(frozen=True)
class SampledRate:
    """The rate of one parametrised case.

    Attributes:
        file: The path as the user named it.
        group: Name of the parametrised case; empty when there is one.
        rate: The rate of its samples.
        outcome: `passed` when the rate is confirmed.
    """

    file: str
    group: str
    rate: SuccessRate
    outcome: Outcome


def with_starts(rate: SuccessRate, results: Sequence[CaseResult]) -> SuccessRate:
    """A rate with how many of its samples have overlapping objects at the start."""
    return replace(
        rate,
        overlapping=sum(result.overlap > 0 for result in results),
        redrawn=sum(result.redraws > 0 for result in results),
        redraws=sum(result.redraws for result in results),
    )


def missed(rates: Sequence[SampledRate]) -> str:
    """`1 of 4 success rates not confirmed`; empty where all are.

    It fails a suite all of whose cases pass.
    """
    count = sum(each.outcome != "passed" for each in rates)
    return f"{count} of {len(rates)} success rates not confirmed" if count else ""


def rate_line(name: str, rate: SuccessRate, style: Style = PLAIN) -> str:
    """A mark and the text of a rate under its name."""
    return f"{style.mark(rate.verdict == 'shown')} {rate_text(name, rate)}"


def rate_text(name: str, rate: SuccessRate) -> str:
    """`pick: 187 of 200 samples passed, 93.5% (...): at least 90% is confirmed`."""
    count = f"{rate.invalid} sample{'s' if rate.invalid != 1 else ''}"
    if not rate.total:
        why = f"{count} invalid" if rate.invalid else "no sample ended"
        return f"{name}: no rate, {why}"
    line = f"{name}: {rate.passed} of {rate.total} samples passed, {rate.passed / rate.total:.1%}"
    line += f" ({rate.low:.1%} to {rate.high:.1%} at {rate.confidence:.0%} confidence)"
    if rate.invalid:
        line += f", {count} invalid and not counted"
    if rate.is_one_run:
        line += f"; the {rate.total} samples are one and the same run (equal digests): nothing that"
        line += " `randomize` or the seed changes matters here, so they show no rate"
    if rate.at_least is None:
        is_shown = rate.verdict == "shown"
        line += "" if is_shown else "; every one must pass, as the file has no `expect_rate`"
    elif not rate.is_one_run:
        required = f"at least {rate.at_least:.1%}"
        line += {
            "shown": f": {required} is confirmed",
            "refuted": f": {required} is refuted",
            "open": f": {required} is not confirmed: take more samples, or require less",
        }[rate.verdict]
    if rate.stopped_early:
        line += "; the sequential test needed no more"
    if rate.overlapping:
        line += f"; objects overlap at the start of {rate.overlapping} of them"
        line += " (`redraw_overlaps: true` draws such samples again)"
    if rate.redrawn:
        line += f"; {rate.redrawn} were drawn again, {rate.redraws} times in all,"
        line += " because objects overlapped at the start"
    return line


def table_lines(
    cases: Sequence[tuple[Mapping[str, Any], bool]], style: Style = PLAIN
) -> Iterator[str]:
    """Passed of all, by each quantity that varies; the worst rows show where to look.

    Args:
        cases: What varied in each case, and whether it passed.
        style: The style of the terminal.
    """
    paths = dict.fromkeys(path for values, _ in cases for path in values)
    for path in paths:
        rows = _rows([(values[path], good) for values, good in cases if path in values])
        if len(rows) < 2:
            continue
        yield style.strong(path)
        width = max(len(label) for label, _, _ in rows)
        for label, passed, total in rows[:MOST_ROWS]:
            mark = style.mark(passed == total)
            yield f"  {mark} {label:<{width}}  {passed:>4} of {total:<4} {passed / total:7.1%}"
        if len(rows) > MOST_ROWS:
            yield f"  ... {len(rows) - MOST_ROWS} more"


def short_value(value: Any) -> str:
    """A value that varies with four digits, in the unit that it is written in."""
    try:
        number, unit = split_quantity(value)
    except ValueError:
        return str(value)
    return f"{number:.4g} {unit}".rstrip()


def _rows(entries: Sequence[tuple[Any, bool]]) -> list[tuple[str, int, int]]:
    """Label, passed and total of each value, or of each part of a range of numbers."""
    try:
        numbers = [split_quantity(value) for value, _ in entries]
    except ValueError:
        numbers = []
    if numbers and len({value for value, _ in numbers}) > BINS:
        return _binned([number for number, _ in numbers], [g for _, g in entries], numbers[0][1])
    found: dict[str, list[bool]] = {}
    for index, (value, is_good) in enumerate(entries):
        number, unit = numbers[index] if numbers else (0.0, "")
        label = f"{number:.6g} {unit}".rstrip() if numbers else str(value)
        found.setdefault(label, []).append(is_good)
    return [(label, sum(goods), len(goods)) for label, goods in found.items()]


def _binned(
    numbers: Sequence[float], goods: Sequence[bool], unit: str
) -> list[tuple[str, int, int]]:
    order = sorted(range(len(numbers)), key=lambda index: numbers[index])
    rows: list[tuple[str, int, int]] = []
    for part in range(BINS):
        chosen = order[part * len(order) // BINS : (part + 1) * len(order) // BINS]
        label = f"{numbers[chosen[0]]:.4g} to {numbers[chosen[-1]]:.4g} {unit}".rstrip()
        rows.append((label, sum(goods[index] for index in chosen), len(chosen)))
    return rows
