"""Success rates of samples, as lines for the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count
from statistics import NormalDist
from typing import Any, Literal

from harness.core.printable import counted
from harness.core.proportion import wilson_interval
from harness.core.quantity import split_quantity
from harness.recording.run import Outcome
from harness.reporting.terminal import PLAIN, Style

RateVerdict = Literal["shown", "refuted", "open"]


@dataclass(frozen=True)
class SuccessRate:
    """How many samples passed, and what that shows.

    Attributes:
        passed: The number of `total` that passed.
        total: Samples that count: up to where the sequential test ended the sampling.
        low: Lower end of Wilson's interval.
        at_least: Required rate; None when the file requires none.
        verdict: `shown` when the rate is at least the required one, `refuted` when not, `open`
            when these samples do not decide.
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

    @property
    def more(self) -> int:
        """How many more samples decide an open rate if as many of them pass; 0: no number does."""
        required, share = self.at_least or 0.0, self.passed / self.total
        if share == required:
            return 0
        z = NormalDist().inv_cdf(0.5 + self.confidence / 2)
        least = int(required * (1 - required) * (z / (share - required)) ** 2)  # before rounding
        for more in count(max(1, least - self.total)):
            passed = self.passed + (math.floor if share > required else math.ceil)(more * share)
            low, high = wilson_interval(passed, self.total + more, self.confidence)
            if low >= required or high < required:
                return more
        return 0


@dataclass(frozen=True)
class SampledRate:
    """The rate of one parametrised case.

    Attributes:
        group: Name of the parametrised case; empty when there is one.
        outcome: `passed` when the rate is confirmed.
    """

    file: str
    group: str
    rate: SuccessRate
    outcome: Outcome


def with_starts(rate: SuccessRate, starts: Sequence[tuple[bool, int]]) -> SuccessRate:
    """A rate with how many of its samples have overlapping objects at the start.

    Args:
        starts: Whether objects overlap, and the number of redraws, of samples that have either.
    """
    return replace(
        rate,
        overlapping=sum(is_overlapping for is_overlapping, _ in starts),
        redrawn=sum(redraws > 0 for _, redraws in starts),
        redraws=sum(redraws for _, redraws in starts),
    )


def missed(rates: Sequence[SampledRate]) -> str:
    """`2 of 4 success rates not confirmed`, which fails a suite; empty where none is missed."""
    required = [each for each in rates if each.rate.at_least is not None or each.rate.is_one_run]
    unconfirmed = sum(each.outcome != "passed" for each in required)
    text = f"{unconfirmed} of {len(required)} success rates" if required[1:] else "success rate"
    return f"{text} not confirmed" if unconfirmed else ""


def rate_line(name: str, rate: SuccessRate, style: Style = PLAIN) -> str:
    """A mark and the text of a rate under its name."""
    return f"{style.mark(rate.verdict == 'shown')} {rate_text(name, rate)}"


def rate_text(name: str, rate: SuccessRate) -> str:
    """`pick: 187 of 200 samples passed, 93.5% (...): at least 90% is confirmed`."""
    invalid = f"{counted(rate.invalid, 'sample')} invalid"
    if not rate.total:
        return f"{name}: no rate, {invalid if rate.invalid else 'no sample ended'}"
    line = f"{name}: {rate.passed} of {rate.total} samples passed, {rate.passed / rate.total:.1%}"
    line += f" ({rate.low:.1%} to {rate.high:.1%} at {rate.confidence:.0%} confidence)"
    if rate.invalid:
        line += f", {invalid} and not counted"
    if rate.is_one_run:
        line += f"; the {rate.total} samples are one and the same run (equal digests): nothing that"
        line += " `randomize` or the seed changes matters here, so they show no rate"
    if rate.at_least is None and rate.verdict != "shown":
        line += "; no rate is required (`expect_rate`), so every one must pass"
    elif rate.at_least is not None and not rate.is_one_run:
        way = "as many pass as are required; take many more samples"
        if rate.verdict == "open" and rate.more:
            way = f"if as many pass, {counted(rate.more, 'more sample')} would decide it"
        ends = {
            "shown": "confirmed",
            "refuted": "refuted",
            "open": f"undecided: {way}, or require less",
        }
        line += f": at least {rate.at_least:.1%} is {ends[rate.verdict]}"
    if rate.stopped_early:
        line += "; the sequential test needed no more"
    if rate.overlapping:
        line += f"; objects overlap at the start of {rate.overlapping} of them"
        line += " (`redraw_overlaps: true` draws such samples again)"
    if rate.redrawn:
        line += f"; {rate.redrawn} were drawn again, {rate.redraws} times in all,"
        line += " because objects overlapped at the start"
    return line


def short_value(value: Any) -> str:
    """A value that varies with four digits, in the unit that it is written in."""
    try:
        number, unit = split_quantity(value)
    except ValueError:
        return str(value)
    return f"{number:.4g} {unit}".rstrip()
