"""Temporal words as reductions of a margin over samples: always, never, eventually, at the end.

A margin is not negative where its predicate holds. Spans of time are exact to the sample: a
predicate is held for T from sample i when it holds at every sample up to the first one that is T
later or more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.recording.run import TIME_RESOLUTION

BRIDGE = 0.1  # gaps under this time end neither a contact between objects nor a hold [s]
FOREVER = 1e9  # longer than any time that an expectation names [s]


@dataclass(frozen=True)
class Decision:
    """The result of a reduction over time.

    Attributes:
        value: Signed so that the expectation holds where it is not negative (never: positive).
        index: The sample that decided it.
    """

    value: float
    index: int
    holds: bool


class TooShort(Exception):
    """No sample of the window leaves room for the required time."""


def later(times: FloatArray) -> FloatArray:
    """The times of a window that was cut short, and two after them: the next, and the last."""
    return np.append(times, [times[-1] + 2 * TIME_RESOLUTION, times[-1] + FOREVER])


def with_future(values: FloatArray, value: float) -> FloatArray:
    """Values of a window that was cut short, and what they would be from there on."""
    return np.append(values, [value, value])


def range_min(values: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """Minimum of values[first[k]:last[k] + 1] for each k, by doubling; ranges must not be empty."""
    lengths = last - first + 1
    levels = np.frexp(lengths)[1] - 1  # floor(log2(length))
    result = np.empty(len(first))
    table = values
    for level in range(int(levels.max(initial=-1)) + 1):
        if level:
            half = 1 << (level - 1)
            table = np.minimum(table[:-half], table[half:])
        chosen = levels == level
        ends = last[chosen] - (1 << level) + 1
        result[chosen] = np.minimum(table[first[chosen]], table[ends])
    return result


def first_within(times: FloatArray, span: float) -> IntArray:
    """The first of the samples of the last `span` seconds at each sample, itself included."""
    return np.searchsorted(times, times - span - TIME_RESOLUTION)


def last_within(times: FloatArray, span: float) -> IntArray:
    """The last of the samples of the next `span` seconds at each sample, itself included."""
    return np.searchsorted(times, times + span + TIME_RESOLUTION, side="right") - 1


def trailing_max(values: FloatArray, times: FloatArray, span: float) -> FloatArray:
    """Largest value of the last `span` seconds at each sample, itself included."""
    return -range_min(-values, first_within(times, span), np.arange(len(times)))


def without_gaps(values: FloatArray, times: FloatArray, span: float) -> FloatArray:
    """Values of which gaps of up to `span` seconds are closed, with the smaller value around them.

    No value becomes smaller, and nothing lasts longer at its ends. What is not known stays so.
    """
    known, here = np.nan_to_num(values), np.arange(len(times))
    last = last_within(times, span)
    lasting = range_min(trailing_max(known, times, span), here, last)
    to_come = -range_min(-known, here, last)
    return np.where(np.isnan(values), np.nan, np.minimum(lasting, to_come))


def episodes(mask: BoolArray) -> list[tuple[int, int]]:
    """Runs of true samples as (start, stop), in order."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def bridged(times: FloatArray, spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The same spans with gaps shorter than `BRIDGE` closed."""
    joined: list[tuple[int, int]] = []
    for start, stop in spans:
        if joined and times[start] - times[joined[-1][1] - 1] < BRIDGE:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return joined


def longest_hold(values: FloatArray, times: FloatArray, *, is_first: bool = False) -> float:
    """Longest time without a break for which a margin is not negative [s].

    Args:
        values: The margins of a predicate, shape (n,).
        is_first: Only the time that begins with the first sample counts.
    """
    spans = [
        times[stop - 1] - times[start]
        for start, stop in episodes(values >= 0)
        if not (is_first and start)
    ]
    return float(max(spans, default=0.0))


def _best(values: FloatArray, progress: FloatArray | None) -> int:
    """First place of the maximum; among equals the one that came furthest."""
    largest = np.flatnonzero(values == values.max())
    if progress is None or len(largest) == 1:
        return int(largest[0])
    return int(largest[np.argmax(np.nan_to_num(progress[largest], nan=-np.inf))])


def spans(times: FloatArray, hold: float | None, within: float | None) -> tuple[IntArray, IntArray]:
    """First and last sample of each span of `hold` seconds that begins within the time for it.

    Raises:
        TooShort: There is none.
    """
    starts = np.arange(len(times))
    if within is not None:
        starts = starts[times <= times[0] + within + TIME_RESOLUTION]
    if hold is None:
        return starts, starts
    ends = np.searchsorted(times, times[starts] + hold - TIME_RESOLUTION)
    fits = ends < len(times)
    if not fits.any():
        raise TooShort
    return starts[fits], ends[fits]


def eventually(
    values: FloatArray,
    times: FloatArray,
    hold: float | None = None,
    within: float | None = None,
    progress: FloatArray | None = None,
) -> Decision:
    """The best moment: held for `hold` seconds from it on, begun within `within` of the start.

    Args:
        values: Margins, shape (n,), n > 0, without NaN.
        hold: Must be held so long without a break [s].
        within: Latest beginning after the first sample [s].
        progress: Chooses the deciding sample among equal margins, shape (n,). Among spans of equal
            margins the one with most samples that hold is chosen; where none holds, the one that
            came furthest.

    Raises:
        TooShort: No sample that may begin it is followed by `hold` seconds.
    """
    starts, ends = spans(times, hold, within)
    if hold is None:
        index = _best(values[starts], None if progress is None else progress[starts])
        return Decision(float(values[index]), index, bool(values[index] >= 0))
    minima = range_min(values, starts, ends)
    holding = np.concatenate([[0], np.cumsum(values >= 0)])
    reached = (holding[ends + 1] - holding[starts]).astype(float)
    if progress is not None and not reached.any():
        reached = -range_min(-np.nan_to_num(progress, nan=-np.inf), starts, ends)
    best = _best(minima, reached)
    span = slice(starts[best], ends[best] + 1)
    index = int(starts[best]) + _best(-values[span], None if progress is None else progress[span])
    return Decision(float(minima[best]), index, bool(minima[best] >= 0))


def always(
    values: FloatArray, times: FloatArray, hold: float | None = None, within: float | None = None
) -> Decision:
    """The worst sample; with `within`, only from that time after the start on."""
    begin = 0
    if within is not None:
        begin = _last_before(times, float(times[0]) + within)
    if hold is not None:
        begin = min(begin, _first_of_last(times, hold))
    return _worst_from(begin, values)


def never(
    values: FloatArray,
    times: FloatArray,
    hold: float | None = None,
    within: float | None = None,
    progress: FloatArray | None = None,
) -> Decision:
    """The opposite of `eventually`: where that holds, even with a margin of zero, this does not."""
    best = eventually(values, times, hold, within, progress)
    return Decision(-best.value, best.index, not best.holds)


def at_end(
    values: FloatArray,
    times: FloatArray,
    hold: float | None = None,
    within: float | None = None,
    progress: FloatArray | None = None,
) -> Decision:
    """The last sample, or the last `hold` seconds; with `within` it must come true by then too.

    Raises:
        TooShort: The window is shorter than `hold`.
    """
    begin = len(times) - 1 if hold is None else _first_of_last(times, hold)
    decision = _worst_from(begin, values)
    if within is None:
        return decision
    came_true = eventually(values, times, hold, within, progress)
    return came_true if came_true.value < decision.value else decision


def _first_of_last(times: FloatArray, span: float) -> int:
    """The last sample that is `span` seconds or more before the end.

    Raises:
        TooShort: The samples cover less.
    """
    if times[-1] - times[0] < span - TIME_RESOLUTION:
        raise TooShort
    return _last_before(times, float(times[-1]) - span)


def _worst_from(begin: int, values: FloatArray) -> Decision:
    """The smallest margin from a sample on decides."""
    index = begin + int(np.argmin(values[begin:]))
    return Decision(float(values[index]), index, bool(values[index] >= 0))


def _last_before(times: FloatArray, time: float) -> int:
    """The last sample that is not after a time."""
    return int(np.count_nonzero(times <= time + TIME_RESOLUTION)) - 1
