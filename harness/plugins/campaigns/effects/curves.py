"""How success, or the worst margin, goes with one parameter: a curve with its interval."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.proportion import wilson_interval
from harness.core.types import FloatArray, IntArray
from harness.plugins.campaigns.effects.quantity_words import name_in_words
from harness.reporting.suite.columns import VariedQuantity

CONFIDENCE = 0.95  # of the intervals of a curve
RUNS_OF_A_POINT = 5  # at least; a proportion of fewer runs has an interval of nearly everything
MOST_POINTS = 8  # of a curve 300 pixels wide
WIDTH, HEIGHT = 300, 90  # [pixels]


@dataclass(frozen=True)
class CurvePoint:
    """A part of a parameter's range, or one of its values.

    Attributes:
        x: The place along the axis of the parameter [pixels].
        y: The place of the measured value; 0 is the top [pixels].
        top: The place of the upper end of the interval [pixels].
        bottom: The place of its lower end [pixels].
        label: The value of a word; empty of a number.
        text: The numbers in words.
    """

    x: float
    y: float
    top: float
    bottom: float
    label: str
    text: str


@dataclass(frozen=True)
class Curve:
    """A curve over one parameter.

    Attributes:
        title: What is drawn, in words.
        points: The points from the lowest value to the highest one; those of words in their order.
        is_line: Whether the points are of numbers, which a line joins.
        ends: The ends of the parameter's axis in words; empty of words.
        scale: The ends of the vertical axis in words, the upper one first.
    """

    title: str
    points: Sequence[CurvePoint]
    is_line: bool
    ends: tuple[str, str]
    scale: tuple[str, str]
    width: int = WIDTH
    height: int = HEIGHT

    @property
    def line(self) -> str:
        """The measured values, for `polyline`."""
        return " ".join(f"{each.x:.1f},{each.y:.1f}" for each in self.points)

    @property
    def band(self) -> str:
        """The interval, for `polygon`."""
        there = [f"{each.x:.1f},{each.top:.1f}" for each in self.points]
        back = [f"{each.x:.1f},{each.bottom:.1f}" for each in reversed(self.points)]
        return " ".join([*there, *back])

    @property
    def text(self) -> str:
        """The whole curve in words."""
        return f"{self.title}. " + "; ".join(each.text for each in self.points)


def curve_of(
    parameter: VariedQuantity,
    chosen: IntArray,
    is_good: NDArray[np.bool_],
    shares: FloatArray | None = None,
) -> Curve | None:
    """The success rate of runs over a parameter with Wilson's interval, or their worst margins.

    Args:
        chosen: Indices of the runs.
        is_good: Whether each of all runs passed.
        shares: The worst margin of each of all runs as a share of its limit; given where no run
            failed. Their median is drawn, with the middle half of them.

    Returns:
        None where the runs do not differ in the parameter.
    """
    numbers = parameter.numbers[chosen]
    known = chosen[np.isfinite(numbers)]
    if shares is not None:
        known = known[np.isfinite(shares[known])]
    numbers = parameter.numbers[known]
    if len(np.unique(numbers)) < 2:
        return None
    parts = list(_parts(numbers, has_words=bool(parameter.words)))
    values = [_value(known[part], is_good, shares) for part in parts]
    top = 1.0 if shares is None else max(high for _, _, high, _ in values) or 1.0
    bottom = 0.0 if shares is None else min(0.0, *(low for _, low, _, _ in values))
    low, high = float(numbers.min()), float(numbers.max())

    def y(value: float) -> float:
        return HEIGHT * (top - value) / (top - bottom)

    points: list[CurvePoint] = []
    for place, (part, (value, least, most, said)) in enumerate(zip(parts, values, strict=True)):
        first, last = float(numbers[part].min()), float(numbers[part].max())
        if parameter.words:
            label = parameter.words[int(first)]
            x, where = WIDTH * (place + 0.5) / len(parts), label
        else:
            x, label = WIDTH * (float(numbers[part].mean()) - low) / (high - low), ""
            where = f"{first:.3g}" if first == last else f"{first:.3g} to {last:.3g}"
            where = f"{where} {parameter.unit}".rstrip()
        points.append(CurvePoint(x, y(value), y(most), y(least), label, f"{where}: {said}"))
    what = "Success rate" if shares is None else "Worst margin"
    ends = ("", "") if parameter.words else (f"{low:.3g}", f"{high:.3g} {parameter.unit}".rstrip())
    scale = f"{top:.0%}", f"{bottom:.0%}"
    title = f"{what} over {name_in_words(parameter)}"
    return Curve(title, points, not parameter.words, ends, scale)


def _parts(numbers: FloatArray, *, has_words: bool) -> Iterator[IntArray]:
    """Places of equal values where there are few of them, else of neighbours in equal number."""
    distinct = np.unique(numbers)
    if has_words or len(distinct) <= MOST_POINTS:
        for value in distinct[:MOST_POINTS]:
            yield np.flatnonzero(numbers == value)
        return
    count = min(MOST_POINTS, max(2, len(numbers) // RUNS_OF_A_POINT))
    yield from np.array_split(np.argsort(numbers, kind="stable"), count)


def _value(
    runs: IntArray, is_good: NDArray[np.bool_], shares: FloatArray | None
) -> tuple[float, float, float, str]:
    """The value of some runs, the ends of its interval, and all of it in words."""
    if shares is not None:
        low, middle, high = (float(each) for each in np.quantile(shares[runs], [0.25, 0.5, 0.75]))
        return middle, low, high, f"median {middle:.0%} of the limit in {len(runs)} runs"
    passed, total = int(is_good[runs].sum()), len(runs)
    low, high = wilson_interval(passed, total, CONFIDENCE)
    said = f"{passed} of {total} passed ({low:.0%} to {high:.0%} at {CONFIDENCE:.0%} confidence)"
    return passed / total, low, high, said
