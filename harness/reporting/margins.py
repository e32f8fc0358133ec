"""Margins of different units side by side: each as a share of its limit."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.recording.verdict import Measure, Verdict

SMALL = 0.05  # a margin that is a smaller share than this is worth a look before it is gone
MOST_USED = 100.0  # a value that misses its limit by more uses no more of the allowance


def margin_share(verdict: Verdict) -> float:
    """The margin as a share of its limit, or of the value where that is larger.

    A margin below a ceiling is a share of what lies between limit and ceiling. 1 is the largest
    share, also where the limit is 0; it is negative where the expectation failed, and NaN where the
    verdict has no margin.
    """
    if math.isnan(verdict.margin):
        return math.nan
    deciding = deciding_measures(verdict)
    scale = max((_scale(each, verdict.margin >= 0) for each in deciding), default=0.0)
    share = verdict.margin / scale if scale > 0 else math.copysign(1.0, verdict.margin)
    return max(-1.0, min(1.0, share))


def worst(verdicts: Sequence[Verdict]) -> Verdict | None:
    """The verdict nearest to failing, or farthest beyond; None where none has a margin."""
    with_margin = [each for each in verdicts if not math.isnan(each.margin)]
    if len(with_margin) < 2:
        return with_margin[0] if with_margin else None
    return min(with_margin, key=margin_share)


def deciding_measures(verdict: Verdict) -> list[Measure]:
    """The measures that the margin is of: as far from their limit as it says."""
    limited = [each for each in verdict.measures if math.isfinite(each.limit)]
    near = [
        each
        for each in limited
        if math.isclose(abs(each.value - each.limit), abs(verdict.margin), rel_tol=1e-6)
    ]
    return near or limited


def _scale(measure: Measure, is_passed: bool) -> float:
    if is_passed and measure.comparison == ">=" and math.isfinite(measure.ceiling):
        return measure.ceiling - measure.limit
    return max(abs(measure.limit), abs(measure.value)) if math.isfinite(measure.value) else 0.0


def tightest_name(verdict: Verdict) -> str:
    """What a verdict that passed has its margin of; empty where it is the required quantity."""
    if verdict.status != "passed" or not verdict.measures:
        return ""
    deciding, required = deciding_measures(verdict), verdict.measures[0]
    has_bound = math.isfinite(required.limit) and required.comparison != "=="
    return deciding[0].name if deciding and has_bound and required not in deciding else ""


def used_allowance(verdict: Verdict) -> float | None:
    """Share of the allowance of the measure that decided a verdict; None where none has one."""
    shares = [allowance_used(measure) for measure in deciding_measures(verdict)]
    return next((share for share in shares if share is not None), None)


def allowance_used(measure: Measure) -> float | None:
    """Share of the allowance that was used: 0 is best, 1 at the limit; None where it has no limit.

    It is the rest of `margin_share` where the expectation passed, and above 1 where it failed.
    """
    value, limit = measure.value, measure.limit
    if not (math.isfinite(value) and math.isfinite(limit)) or measure.comparison == "==":
        return None
    if measure.comparison == "<=":
        return max(0.0, value) / limit if limit > 0 else None
    if value >= limit and math.isfinite(measure.ceiling):
        room = measure.ceiling - limit
        return (measure.ceiling - value) / room if room > 0 else 0.0
    if limit <= 0:
        return None
    return limit / value if value > limit / MOST_USED else MOST_USED
