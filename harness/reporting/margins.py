"""Margins of different units side by side: each as a share of its limit."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.recording.run import Measure, Verdict

SMALL = 0.05
"""A margin that is a smaller share than this is worth a look before it is gone."""


def margin_share(verdict: Verdict) -> float:
    """The margin as a share of what its limit, or the value beside it, is worth.

    1 is as far as it goes where the limit is 0; negative where the expectation failed; NaN where
    the verdict has no margin.
    """
    if math.isnan(verdict.margin):
        return math.nan
    scale = max((_scale(each) for each in _deciding(verdict)), default=0.0)
    share = verdict.margin / scale if scale > 0 else math.copysign(1.0, verdict.margin)
    return max(-1.0, min(1.0, share))


def worst(verdicts: Sequence[Verdict]) -> Verdict | None:
    """The verdict nearest to failing, or farthest beyond; None where none has a margin."""
    told = [each for each in verdicts if not math.isnan(each.margin)]
    return min(told, key=margin_share, default=None)


def _deciding(verdict: Verdict) -> list[Measure]:
    """The measures that the margin is of: as far from their limit as it says."""
    limited = [each for each in verdict.measures if math.isfinite(each.limit)]
    near = [
        each
        for each in limited
        if math.isclose(abs(each.value - each.limit), abs(verdict.margin), rel_tol=1e-6)
    ]
    return near or limited


def _scale(measure: Measure) -> float:
    return max(abs(measure.limit), abs(measure.value)) if math.isfinite(measure.value) else 0.0
