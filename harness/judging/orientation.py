"""Measures of `never`, and of an expected collision: their limits are reversed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from harness.recording.verdict import Measure


def against(measures: Sequence[Measure], *, is_passed: bool) -> tuple[Measure, ...]:
    """A predicate's measures as `never` reads them.

    A predicate holds where all its measures stand as they must; `never` passes where one does not.
    That one is shown with its limit reversed, the others as plain numbers. Measures that count
    against the predicate from the start, as those of `collision` do, stay as they are.
    """
    limited = [each for each in measures if math.isfinite(each.limit)]
    broken = [each for each in limited if not holds(each)]
    if not is_passed:
        return tuple(map(turned, measures)) if not broken else tuple(measures)
    if not broken:
        return tuple(measures)
    return tuple(
        turned(each) if each in broken else replace(each, limit=math.nan) for each in measures
    )


def holds(measure: Measure) -> bool:
    """Whether a value satisfies its limit."""
    value, limit = measure.value, measure.limit
    match measure.comparison:
        case "<=":
            return value <= limit
        case ">=":
            return value >= limit
        case "==":
            return value == limit


def turned(measure: Measure) -> Measure:
    """The measure with its limit reversed; unchanged without a limit, or for an equality."""
    match measure.comparison:
        case "<=":
            return replace(measure, comparison=">=")
        case ">=":
            return replace(measure, comparison="<=")
        case "==":
            return measure
