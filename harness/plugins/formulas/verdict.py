"""formula: signal temporal logic over a window, with bounds where the recording ends too early.

Each node has two margins at every sample: what it is at least and what it is at most, whatever
would have followed after the last sample and whatever a missing sample was. They are equal where
the record decides. `always[0, 5]` of which three seconds were recorded is at most their minimum
and at least minus infinity; so it may have failed, and cannot have passed.

Between two samples nothing is known: `always[a, b]` reads every sample from `a` on up to the first
one that is at `b` or later, `eventually[a, b]` and `until[a, b]` at those from `a` up to `b`.

The package rtamt (0.4.10) was tried and not taken: its discrete monitor counts samples,
`always[0, 5]` of three samples passes there, a NaN is lost in a minimum, its compiled parser is
bound to one version of ANTLR, and `until[0, 500]` over 5000 samples, half a second of a run, takes
minutes (0.4 s with 100 over 1000, growing with the product of window and samples; here 5 ms). The
definitions are written as loops in `tests/judging/test_formula.py`, and random formulas on
random signals agree with them.

References:
    [1] A. Donze, O. Maler, "Robust Satisfaction of Temporal Logic over Real-Valued Signals",
        FORMATS 2010: margins, and bounded `until` from the unbounded one.
    [2] J. Deshmukh et al., "Robust Online Monitoring of Signal Temporal Logic", RV 2015: bounds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from harness.core.amounts import amount, amounts
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.judging.contacts import FORCE_WINDOW
from harness.judging.temporal import TIME_RESOLUTION, range_min
from harness.judging.window import NotObservable, NotReached, Window
from harness.judging.words import ALREADY_TRUE, HARDLY_OBSERVED
from harness.plugins.formulas.language.formula import (
    Comparison,
    Interval,
    Logic,
    Node,
    Number,
    Signal,
    Temporal,
    parts_of,
    premises_of,
    signals_of,
    text_of,
)
from harness.plugins.formulas.language.parser import parse_formula
from harness.plugins.formulas.signals import Values, values_of
from harness.recording.verdict import Measure, Observed, Verdict, VerdictStatus, VerdictWarning

PLOTS = {
    "position": "position",
    "command": "position",
    "velocity": "velocity",
    "effort": "effort",
    "force": "contact",
    **{f"force_{axis}": "wrench_force" for axis in "xyz"},
    **{f"torque_{axis}": "wrench_torque" for axis in "xyz"},
    "distance": "clearance",
    "speed": "displacement",
}
"""The plot that the report shows for a comparison of a signal, by the signal's name."""

TINY = float(np.nextafter(0.0, 1.0))  # for a margin of zero on the side that the comparison says


@dataclass(frozen=True, eq=False)
class Bounds:
    """The least and the largest margin that a formula can have at each sample, shape (n,)."""

    low: FloatArray
    high: FloatArray

    def __neg__(self) -> Bounds:
        return Bounds(-self.high, -self.low)


def formula_verdict(text: str, window: Window, force_window: float = FORCE_WINDOW) -> Verdict:
    """The verdict of a formula at the first sample of a window, without its place in the file.

    Raises:
        NotReached: The window ended before the formula was decided.
        NotObservable: A signal was not recorded, or is not known where it would have decided.
    """
    evaluation = Evaluation(window, force_window)
    root = parse_formula(text)
    if not signals_of(root):
        raise NotObservable("the formula reads no signal of the run")
    bounds = evaluation.bounds(root)
    low, high = float(bounds.low[0]), float(bounds.high[0])
    if low < 0 < high:
        missing = evaluation.first_unknown(root)
        if missing:
            raise NotObservable(missing)
        near = Evaluation(window, force_window, is_near=True).bounds(root)
        if near.low[0] > 0 or near.high[0] < 0:
            cutoff = amount(window.run.signals.clearance_cutoff, "m")
            raise NotObservable(f"distances were recorded up to {cutoff} only")
        undefined = evaluation.first_undefined(root)
        if undefined:
            raise NotObservable(undefined)
        raise NotReached("the time it is judged over ended before it was decided")
    holds = low > 0
    is_open = bool(window.cut_short) and not holds
    if is_open and Evaluation(window, force_window, is_open=True).bounds(root).high[0] > 0:
        raise NotReached(window.cut_short)
    value = low if holds else high
    comparison, index, sign = evaluation.decider(root, 0, at_least=holds)
    time = window.time(index)
    left = evaluation.values(comparison.left)
    right = evaluation.values(comparison.right)
    unit = left.unit or right.unit or "1"
    actual, limit = float(left.values[index]), float(right.values[index])
    way = "holds" if holds == (sign > 0) else "does not hold"
    reason = f"{comparison.text} {way}: {' against '.join(amounts(actual, limit, unit))}"
    above = comparison.operator.startswith(">") == (sign > 0)
    measure = Measure(
        str(comparison.left) if isinstance(comparison.left, Signal) else comparison.text,
        actual,
        limit,
        ">=" if above else "<=",
        unit,
        time,
        plot=next((PLOTS.get(each.name, "") for each in signals_of(comparison.left)), ""),
    )
    status: VerdictStatus = "passed" if holds else "failed"
    return Verdict(
        "",
        status,
        0.0 if abs(value) <= TINY else value,
        unit,
        time,
        reason=f"{reason} at t={time:.3f} s{_about_forces(comparison, force_window)}",
        measures=(measure,),
        observed=evaluation.observed(root),
        warnings=evaluation.warnings(root) if holds else (),
    )


def _about_forces(comparison: Comparison, span: float) -> str:
    """Over which time forces that decided are averaged; empty where none did."""
    if not any(each.name.startswith(("force", "torque")) for each in signals_of(comparison)):
        return ""
    if span == 0:
        return "; forces are those of single steps of the physics: a contact that bounces has peaks"
    return f"; forces are means over {amount(span, 's')}"


class Evaluation:
    """The bounds of every part of a formula over one window, each calculated once.

    Args:
        window: The samples of the window.
        force_window: Time over which forces are averaged [s].
        is_open: Whether the window continues after its last sample in an unknown way.
        is_near: Whether distances at the cutoff of the recording are no larger than it.
    """

    def __init__(
        self,
        window: Window,
        force_window: float = FORCE_WINDOW,
        *,
        is_open: bool = False,
        is_near: bool = False,
    ) -> None:
        self.window = window
        self.force_window = force_window
        self.is_open = is_open
        self.is_near = is_near
        self.times = window.times
        self._known: dict[int, tuple[Node, Bounds]] = {}

    def values(self, node: Number, *, are_far: bool = False) -> Values:
        """A number of the formula at every sample."""
        return values_of(node, self.window, are_far=are_far, force_window=self.force_window)

    def bounds(self, node: Node) -> Bounds:
        """The bounds of a part of the formula, at every sample."""
        if id(node) not in self._known:
            self._known[id(node)] = (node, self._calculated(node))
        return self._known[id(node)][1]

    def _calculated(self, node: Node) -> Bounds:
        match node:
            case Comparison():
                near, far = self._margin(node, are_far=False), self._margin(node, are_far=True)
                far = near if self.is_near else far
                unknown = np.isnan(near) | np.isnan(far)
                return Bounds(
                    np.where(unknown, -np.inf, np.minimum(near, far)),
                    np.where(unknown, np.inf, np.maximum(near, far)),
                )
            case Logic(operator="not"):
                return -self.bounds(node.operands[0])
            case Logic(operator=operator):
                left, right = map(self.bounds, node.operands)
                if operator == "and":
                    return _each(np.minimum, left, right)
                return _each(np.maximum, -left if operator == "implies" else left, right)
            case Temporal(operator="always"):
                return self._always(self.bounds(node.operands[0]), node.interval)
            case Temporal(operator="eventually"):
                return self._eventually(self.bounds(node.operands[0]), node.interval)
            case Temporal():
                first, second = map(self.bounds, node.operands)
                return self._until(first, second, node.interval)

    def _margin(self, node: Comparison, *, are_far: bool) -> FloatArray:
        left = self.values(node.left, are_far=are_far)
        right = self.values(node.right, are_far=are_far)
        with np.errstate(invalid="ignore"):
            margin = left.values - right.values
        margin = margin if node.operator.startswith(">") else -margin
        # a difference of zero holds for `<=`, not for `<`, and `not` turns that around
        return np.where(margin == 0, TINY if "=" in node.operator else -TINY, margin)

    # -- temporal words ---------------------------------------------------------------------------

    def span(self, interval: Interval, *, is_always: bool) -> tuple[IntArray, IntArray, BoolArray]:
        """First and last sample of an interval from each sample, and where it ends too late.

        Where first > last there is no sample in it.
        """
        times, end = self.times, len(self.times) - 1
        first = np.searchsorted(times, times + interval.first - TIME_RESOLUTION)
        if math.isinf(interval.last):
            return first, np.full(len(times), end), (first > end) | self.is_open
        later = times + interval.last
        if is_always:
            last = np.searchsorted(times, later - TIME_RESOLUTION)
        else:
            last = np.searchsorted(times, later + TIME_RESOLUTION, side="right") - 1
        beyond = later > times[-1] + TIME_RESOLUTION
        return first, np.minimum(last, end), beyond

    def _always(self, inner: Bounds, interval: Interval) -> Bounds:
        first, last, beyond = self.span(interval, is_always=True)
        low = _minima(inner.low, first, last)
        return Bounds(
            np.where(beyond | (first > last), -np.inf, low),
            np.where(first > last, np.inf, _minima(inner.high, first, last)),
        )

    def _eventually(self, inner: Bounds, interval: Interval) -> Bounds:
        first, last, beyond = self.span(interval, is_always=False)
        high = -_minima(-inner.high, first, last)
        return Bounds(
            np.where(first > last, -np.inf, -_minima(-inner.low, first, last)),
            np.where(beyond | (first > last), np.inf, high),
        )

    def _until(self, first: Bounds, second: Bounds, interval: Interval) -> Bounds:
        """A until[a, b] B = eventually[a, b] B and always[0, a) A and at a: A until B [1]."""
        begin, last, beyond = self.span(interval, is_always=False)
        coming = self._eventually(second, interval)
        count = len(self.times)
        low = _unbounded(first.low, second.low, -np.inf)
        high = _unbounded(first.high, second.high, np.inf)
        before = np.arange(count)
        reached = np.minimum(begin, count - 1)
        at_low = np.where(begin < count, low[reached], -np.inf)
        at_high = np.where(beyond | (begin <= last), high[reached], np.inf)
        held_low = _minima(first.low, before, begin - 1)
        held_high = _minima(first.high, before, np.minimum(begin, count) - 1)
        return Bounds(
            np.minimum(np.minimum(coming.low, held_low), at_low),
            np.minimum(np.minimum(coming.high, held_high), at_high),
        )

    # -- what decided -----------------------------------------------------------------------------

    def decider(self, node: Node, index: int, *, at_least: bool) -> tuple[Comparison, int, int]:
        """The comparison and the sample that a bound comes from, and 1, or -1 under a `not`."""
        sign = 1
        while not isinstance(node, Comparison):
            target = self._bound(node, at_least)[index]
            node, index, flips = next(
                (part, int(place), flips)
                for part, places, flips in self._parts(node, index)
                for place in places[self._bound(part, at_least, flips)[places] == target]
            )
            at_least, sign = at_least != flips, -sign if flips else sign
        return node, index, sign

    def _bound(self, node: Node, at_least: bool, flips: bool = False) -> FloatArray:
        bounds = -self.bounds(node) if flips else self.bounds(node)
        return bounds.low if at_least else bounds.high

    def _parts(self, node: Logic | Temporal, index: int) -> list[tuple[Node, IntArray, bool]]:
        """Parts of a formula, the samples at which they matter to it, and whether negated."""
        *before, last_one = node.operands
        if isinstance(node, Logic):
            here, is_not = np.array([index]), node.operator == "not"
            premises = [(part, here, node.operator == "implies") for part in before]
            return [*premises, (last_one, here, is_not)]
        spans = self.span(node.interval, is_always=node.operator == "always")
        first, last = int(spans[0][index]), int(spans[1][index])
        stop = len(self.times) if spans[2][index] else max(first, last)
        earlier = [(part, np.arange(index, stop), False) for part in before]
        return [(last_one, np.arange(first, last + 1), False), *earlier]

    # -- how much was observed --------------------------------------------------------------------

    def observed(self, root: Node) -> Observed:
        """Samples at which every signal is known, and at which the premises hold."""
        unknown = np.zeros(len(self.times), dtype=bool)
        for node in signals_of(root):
            unknown |= np.isnan(self.values(node).values)
        premises = [self._times_true(premise) for premise in premises_of(root)]
        known = int((~unknown).sum())
        return Observed(known, int(unknown.sum()), premises=min(premises, default=None))

    def warnings(self, root: Node) -> tuple[VerdictWarning, ...]:
        """Warnings about a formula that holds, but shows less than it seems to."""
        found = [
            VerdictWarning(
                "premise never held",
                f"at none of {len(self.times)} samples did its premise hold: {text_of(premise)}",
            )
            for premise in premises_of(root)
            if not self._times_true(premise)
        ]
        if len(self.times) > 1 and not _looks_ahead(root):
            message = "no temporal word: it is judged at the first sample, write `always` or"
            found.append(VerdictWarning(HARDLY_OBSERVED, f"{message} `eventually`"))
        inner = _awaited(root)
        if inner is not None and self.bounds(inner).low[0] > 0:
            time = self.window.time(0)
            message = f"{text_of(inner)} held at t={time:.3f} s, the first sample"
            found.append(VerdictWarning(ALREADY_TRUE, message))
        return tuple(found)

    def _times_true(self, node: Node) -> int:
        """Samples at which a part may hold."""
        return int((self.bounds(node).high > 0).sum())

    def first_unknown(self, root: Node) -> str:
        """The first sample at which a signal of the formula is not known; empty if all are."""
        for node in signals_of(root):
            unknown = np.isnan(self.values(node).values)
            if unknown.any():
                time = self.window.time(int(np.argmax(unknown)))
                return f"{node} is not known, or not there, at t={time:.3f} s"
        return ""

    def first_undefined(self, root: Node) -> str:
        """The first sample at which a comparison of known signals has no value; empty if none."""
        for node in parts_of(root):
            if not isinstance(node, Comparison):
                continue
            bounds = self.bounds(node)
            undefined = np.isinf(bounds.low) & np.isinf(bounds.high)
            if undefined.any():
                time = self.window.time(int(np.argmax(undefined)))
                return f"{node.text} has no value at t={time:.3f} s, where it divides by zero"
        return ""


def _looks_ahead(node: Node) -> bool:
    """Whether a formula reads samples after the first one."""
    match node:
        case Temporal():
            return node.interval.last > 0
        case Logic():
            return any(map(_looks_ahead, node.operands))
        case _:
            return False


def _awaited(root: Node) -> Node | None:
    """What must come true for a formula whose outermost word is `eventually` or `until`."""
    match root:
        case Temporal(operator="eventually" | "until", operands=(*_, inner), interval=interval):
            return inner if interval.first == 0 else None
        case _:
            return None


def _each(function: np.ufunc, left: Bounds, right: Bounds) -> Bounds:
    return Bounds(function(left.low, right.low), function(left.high, right.high))


def _minima(values: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """Minimum of each range; inf where it is empty."""
    result = np.full(len(first), np.inf)
    some = first <= last
    result[some] = range_min(values, first[some], last[some])
    return result


def _unbounded(first: FloatArray, second: FloatArray, after: float) -> FloatArray:
    """A until B from every sample on; `after` is the value after the last one."""
    values: list[float] = []
    for held, comes in zip(first[::-1].tolist(), second[::-1].tolist(), strict=True):
        after = max(comes, min(held, after))
        values.append(after)
    return np.array(values[::-1])
