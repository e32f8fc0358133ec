"""Margins of a predicate at every sample of a window, and the measures they come from."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from harness.core.types import BoolArray, FloatArray
from harness.judging.window import Window
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure, VerdictWarning

Comparison = Literal["<=", ">=", "=="]
Margin = FloatArray  # the margin of a predicate at each sample of a window, shape (n,)


@dataclass(frozen=True)
class Evidence:
    """What a sample shows.

    Attributes:
        measures: The measures; where all hold the required quantity, then the tightest first.
        margin: The margin in `unit`, where it says more than the signal's value; else None.
        is_moment: Whether the text is about the sample, rather than of all the time judged.
        time: When what the text says was measured, where it was before the sample; else None [s].
    """

    text: str
    measures: tuple[Measure, ...] = ()
    margin: float | None = None
    unit: str = ""
    is_moment: bool = True
    time: float | None = None


@dataclass(frozen=True, eq=False)
class MarginSignal:
    """How far a predicate is from flipping at each sample of a window.

    Attributes:
        values: The values, not negative where the predicate holds; NaN where it is unknown, shape
            (n,).
        evidence: What the sample at an index of the window shows.
        applies: Samples at which the predicate is defined (default all): distance to an object has
            no value before the object exists. `always` skips the others, nothing holds at them.
        progress: Chooses the sample to show among equal margins.
        present: Samples at which its object is there (default all): a value that is missing at one
            of them is unknown, at another one it does not exist.
        pairs: How many pairs of bodies it reads; None where it reads none.
        warnings: What makes a verdict that holds say less than it seems to.
    """

    values: FloatArray
    unit: str
    evidence: Callable[[int], Evidence]
    applies: BoolArray | None = None
    progress: FloatArray | None = None
    present: BoolArray | None = None
    pairs: int | None = None
    warnings: tuple[VerdictWarning, ...] = ()

    def unknown(self) -> BoolArray:
        """Samples at which there is a value that is not known, shape (n,)."""
        unknown = np.isnan(self.values)
        for mask in (self.applies, self.present):
            unknown = unknown if mask is None else unknown & mask
        return unknown


@dataclass(frozen=True, eq=False)
class Part:
    """One quantity of a predicate, against its limit.

    Attributes:
        values: The measured values in `unit`, shape (n,).
        scale: What a margin is divided by before it is compared with other parts'; by default
            abs(limit).
        relevant: Samples at which the part counts; default all.
        points: The two ends of a distance in the world: the required and the actual place, shape
            (n, 3) each.
        ceiling: The largest value that can be measured, in `unit`; inf where there is none. The
            margin of a value that must be large is a share of what lies between limit and ceiling.
        measured_name: The name of the measure where it holds more than the quantity's.
        measured_unit: The unit where the quantity has several.
        time_of: When the value at an index was measured, where that was before its sample [s].
    """

    quantity: Quantity
    values: FloatArray
    limit: float
    comparison: Comparison
    scale: float | None = None
    relevant: BoolArray | None = None
    detail: str = ""
    points: tuple[FloatArray, FloatArray] | None = None
    ceiling: float = math.inf
    measured_name: str = ""
    measured_unit: str = ""
    time_of: Callable[[int], float] | None = None

    @property
    def name(self) -> str:
        """The name of the part's measure."""
        return self.measured_name or self.quantity.name

    @property
    def unit(self) -> str:
        """The unit of the values, the limit and the margin."""
        return self.measured_unit or self.quantity.unit

    def measure(self, index: int, time: float) -> Measure:
        """The part at a sample, for a verdict."""
        value, (expected, actual) = float(self.values[index]), self.points_at(index)
        time = time if self.time_of is None else self.time_of(index)
        measure = measured(
            self.quantity, value, self.limit, self.comparison, time, self.detail, self.name
        )
        points = {"expected": expected, "actual": actual}
        return replace(measure, unit=self.unit, ceiling=self.ceiling, **points)

    def points_at(self, index: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Expected and actual point of a sample; empty where the part has none."""
        if self.points is None:
            return (), ()
        expected, actual = (tuple(map(float, rows[index])) for rows in self.points)
        return expected, actual

    def margins(self) -> FloatArray:
        """Margins, not negative where the part holds, in `unit` (equality: 1 or -1), shape (n,)."""
        match self.comparison:
            case "<=":
                return self.limit - self.values
            case ">=":
                return self.values - self.limit
            case "==":
                return np.where(self.values == self.limit, 1.0, -1.0)

    def shares(self) -> FloatArray:
        """Margins as shares of the scale; inf where the part does not count, shape (n,)."""
        margins = self.margins()
        scale = abs(self.limit) if self.scale is None else self.scale
        shares = margins / (scale if scale > 0 and self.comparison != "==" else 1.0)
        if math.isfinite(self.ceiling):
            room = self.ceiling - self.limit
            shares = np.where(margins >= 0, margins / room if room > 0 else 1.0, shares)
        return shares if self.relevant is None else np.where(self.relevant, shares, np.inf)


def measured(
    quantity: Quantity,
    value: float,
    limit: float,
    comparison: Comparison,
    time: float,
    detail: str = "",
    name: str = "",
) -> Measure:
    """The measure of a quantity, for a verdict."""
    return Measure(
        name or quantity.name,
        value,
        limit,
        comparison,
        quantity.unit,
        time,
        detail,
        plot=quantity.plot,
    )


def all_of(
    window: Window,
    parts: Sequence[Part],
    text: Callable[[int, Measure], str],
    *,
    present: BoolArray | None = None,
    applies: BoolArray | None = None,
    shown: int = 4,
    is_moment: bool = True,
) -> MarginSignal:
    """The signal of a predicate that holds where all of its parts do.

    One part keeps its unit. Several are compared as shares of their limits; the margin that a
    verdict reports is the tightest part's, in that part's unit.

    Args:
        text: What to say of a sample, given its index and its tightest measure.
        present: Samples at which there is something to judge; NaN elsewhere.
        applies: Samples at which it is defined, as in `MarginSignal`.
        shown: How many measures a verdict shows.
    """
    rows: FloatArray = np.stack([part.shares() for part in parts])
    values: FloatArray = rows.min(axis=0)  # NaN in any part is NaN
    if len(parts) == 1 and parts[0].relevant is None:
        values = parts[0].margins()
    for mask in (present, applies):
        values = values if mask is None else np.where(mask, values, np.nan)

    def evidence(index: int) -> Evidence:
        shares = [float(share) for share in rows[:, index]]
        order = sorted(range(len(parts)), key=shares.__getitem__)
        chosen = [parts[place] for place in order if shares[place] != math.inf]
        stated = list(chosen)
        if shares[order[0]] >= 0:  # all hold: what is required comes first
            stated.sort(key=lambda part: part.quantity is not parts[0].quantity)
            stated[1:] = [part for part in chosen if part is not stated[0]]
        measures = tuple(part.measure(index, window.time(index)) for part in stated[:shown])
        tightest = chosen[0].measure(index, window.time(index))
        unit = "1" if chosen[0].comparison == "==" else chosen[0].unit
        margin = float(chosen[0].margins()[index])
        before = None if chosen[0].time_of is None else tightest.time
        return Evidence(text(index, tightest), measures, margin, unit, is_moment, before)

    unit = parts[0].unit if len(parts) == 1 else "1"
    return MarginSignal(values, unit, evidence, applies, present=present)


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
