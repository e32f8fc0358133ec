"""always, never, eventually, and a bare predicate: from a margin at every sample to a verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.amounts import amount, amounts
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.judging import temporal
from harness.judging.margins import MarginSignal, against
from harness.judging.temporal import Decision, TooShort, later, longest_hold, with_future
from harness.judging.window import NotObservable, NotReached, Window
from harness.language.expectation import PredicateFields, TemporalFields
from harness.recording.verdict import Measure, Observed, Verdict, VerdictStatus, VerdictWarning

ALREADY_TRUE = "already true at the start"  # the warning that nothing had to change

HARDLY_OBSERVED = "hardly observed"
LEAST_SHARE = 0.01
"""The smallest share of a window's samples that says something of the window: what is there for
less, as an object that a step adds at its end, was added next to it rather than in it."""


@dataclass(frozen=True)
class Terms:
    """How a predicate is judged: its temporal word, and the words next to both.

    Attributes:
        word: `always`, `never`, `eventually`, or `at_end` of a bare predicate.
        hold: How long it must hold without a break [s].
        within: The latest beginning after the window's start [s].
        step: The step it is judged over; empty for the whole run.
        is_opposed: Whether the predicate's measures show its violation.
        is_change: Whether something must come true that was not so when the window began.
    """

    word: str
    hold: float | None
    within: float | None
    step: str
    is_opposed: bool = False
    is_change: bool = False


def terms_of(
    word: str,
    fields: Sequence[PredicateFields | TemporalFields],
    step: str,
    *,
    is_opposed: bool,
    is_change: bool = False,
) -> Terms:
    """Words inside and outside a temporal word both count; of two numbers the stricter one.

    Args:
        word: The temporal word, or the `judged` word of a bare predicate.
        step: The step where the expectation stands.

    Raises:
        NotObservable: It names two steps.
    """
    holds = [each.for_ for each in fields if each.for_ is not None]
    withins = [each.within for each in fields if each.within is not None]
    named = {each.during for each in fields if each.during is not None}
    if len(named) > 1:
        raise NotObservable(f"`during` names two steps: {' and '.join(sorted(named))}")
    return Terms(
        word,
        max(holds, default=None),
        min(withins, default=None),
        next(iter(named), step),
        is_opposed,
        is_change,
    )


@dataclass(frozen=True, eq=False)
class _Series:
    """Margins over time.

    Attributes:
        values: The margin at each sample; NaN where it is not known, shape (n,).
        applies: Whether there is something to judge, shape (n,).
        progress: Chooses among equal margins, shape (n,).
    """

    values: FloatArray
    times: FloatArray
    applies: BoolArray
    progress: FloatArray | None

    def reduce(self, terms: Terms) -> Decision:
        """The unknown counts against the expectation; where it does not apply, nothing holds.

        Raises:
            TooShort: No sample leaves room for the required time.
        """
        times, hold, within, progress = self.times, terms.hold, terms.within, self.progress
        unknown = np.isnan(self.values)
        low = np.where(unknown | ~self.applies, -np.inf, self.values)
        match terms.word:
            case "always":
                return temporal.always(low, times, hold, within)
            case "never":
                high = np.where(unknown & self.applies, np.inf, low)
                return temporal.never(high, times, hold, within, progress)
            case "eventually":
                return temporal.eventually(low, times, hold, within, progress)
            case _:
                return temporal.at_end(low, times, hold, within, progress)

    def holds_after(self, terms: Terms, future: float) -> bool:
        """Whether the expectation holds if the margin stays at `future` after the window."""
        continued = _Series(
            with_future(self.values, future),
            later(self.times),
            np.append(self.applies, [True, True]),
            None if self.progress is None else with_future(self.progress, 0.0),
        )
        return continued.reduce(terms).holds


def decide(terms: Terms, window: Window, margins: MarginSignal) -> Verdict:
    """The verdict of a temporal word, without its place in the file.

    Raises:
        NotReached: There was nothing to judge.
        NotObservable: Samples that are not known decide it.
    """
    values, times, unknown = margins.values, window.times, margins.unknown()
    applies = np.ones(len(values), dtype=bool) if margins.applies is None else margins.applies
    known = applies & ~np.isnan(values)
    if not known.any():
        if unknown.any():
            raise NotObservable("its value is not known at any time it is judged over")
        raise NotReached("what it is about was not there in the time it is judged over")
    chosen = np.flatnonzero(applies) if terms.word == "always" else np.arange(len(values))
    series = _Series(values[chosen], times[chosen], applies[chosen], margins.progress)
    try:
        decision = _decision(terms, window, series)
    except TooShort:
        return too_short(terms, series.times)
    if not decision.holds and unknown.any():
        _refuse_unknown(terms, window, unknown, series, chosen)
    observed = Observed(int(known.sum()), int(unknown.sum()), margins.pairs)
    decided = replace(decision, index=int(chosen[decision.index]))
    return _verdict(terms, window, margins, decided, observed)


def _decision(terms: Terms, window: Window, series: _Series) -> Decision:
    """What the samples decide.

    Raises:
        NotReached: What comes after the window could reverse it.
        TooShort: No sample leaves room for the required time.
    """
    is_open = bool(window.cut_short) and series.holds_after(terms, _most_favourable(terms))
    try:
        decision = series.reduce(terms)
    except TooShort:
        if is_open:
            raise NotReached(window.cut_short) from None
        raise
    if is_open and (terms.word == "at_end" or not decision.holds):
        raise NotReached(window.cut_short)
    if decision.holds and _is_undecided(terms, series):
        raise NotReached(window.cut_short or _ended_before(terms, window.times))
    return decision


def _verdict(
    terms: Terms, window: Window, margins: MarginSignal, decision: Decision, observed: Observed
) -> Verdict:
    """The verdict on a decision, with the evidence of the sample that decided it.

    Raises:
        NotReached: It holds where nothing was there.
    """
    values, times, index = margins.values, window.times, decision.index
    status: VerdictStatus = "passed" if decision.holds else "failed"
    if not math.isfinite(decision.value):
        if decision.holds:
            raise NotReached("what it is about was not there for that long")
        time = window.time(index)
        return Verdict("", status, time=time, reason=f"not known, or not there, at t={time:.3f} s")
    lacks = 0.0
    if terms.word == "eventually" and terms.hold is not None and not decision.holds:
        index, lacks = _revealing(terms.hold, values, times, margins.progress, index)
    evidence = margins.evidence(index)
    time = window.time(index) if evidence.time is None else evidence.time
    margin, unit = decision.value, margins.unit
    if evidence.margin is not None:
        margin = -evidence.margin if terms.word == "never" else evidence.margin
        unit = evidence.unit
    reason = evidence.text + (f" at t={time:.3f} s" if evidence.is_moment else "")
    measures = tuple(evidence.measures)
    if terms.word == "never" or terms.is_opposed:
        measures = against(measures, is_passed=decision.holds)
    if lacks and terms.hold is not None:
        margin, unit, held = -lacks, "s", terms.hold - lacks
        measures += (Measure("time without a break", held, terms.hold, ">=", "s", time),)
    return Verdict(
        "",
        status,
        margin + 0.0,
        unit,
        time,
        reason=reason + _held(terms, values, times, decision),
        measures=measures,
        observed=observed,
        warnings=_warnings(terms, window, margins, observed) if decision.holds else (),
    )


def _warnings(
    terms: Terms, window: Window, margins: MarginSignal, observed: Observed
) -> tuple[VerdictWarning, ...]:
    """The warnings of a verdict that passed."""
    return (
        *(margins.warnings if terms.word in ("always", "never") else ()),
        *_already_true(terms, margins.values, window),
        *_hardly_observed(terms, observed.samples, window),
    )


def _most_favourable(terms: Terms) -> float:
    """The margin with which the expectation holds best."""
    return -np.inf if terms.word == "never" else np.inf


def _refuse_unknown(
    terms: Terms, window: Window, unknown: BoolArray, series: _Series, chosen: IntArray
) -> None:
    """Refuse a verdict that favourable values of the unknown samples would reverse."""
    favourable = np.where(unknown[chosen], _most_favourable(terms), series.values)
    if replace(series, values=favourable).reduce(terms).holds:
        first, last = np.flatnonzero(unknown)[[0, -1]]
        raise NotObservable(
            f"{int(unknown.sum())} samples from t={window.time(int(first)):.3f} s to"
            f" t={window.time(int(last)):.3f} s are not known, and would decide it"
        )


def _already_true(terms: Terms, values: FloatArray, window: Window) -> tuple[VerdictWarning, ...]:
    """A warning where something that must come true was so at the first known sample."""
    known = np.flatnonzero(~np.isnan(values))
    if not terms.is_change or not len(known):
        return ()
    first = int(known[0])
    if terms.hold is None:
        held = bool(values[first] >= 0)
    else:
        held = longest_hold(values[first:], window.times[first:], is_first=True)
        held = held >= terms.hold - temporal.TIME_RESOLUTION
    if not held:
        return ()
    message = f"it held at t={window.time(first):.3f} s, the first sample it is judged at"
    return (VerdictWarning(ALREADY_TRUE, message),)


def _hardly_observed(terms: Terms, samples: int, window: Window) -> tuple[VerdictWarning, ...]:
    """A warning where what must always or never hold was there for a moment, or the window is one.

    A step that takes no time, such as one that puts an object somewhere or fails before it moves,
    has one sample: nothing can begin or end in it.
    """
    count = len(window.times)
    if terms.word not in ("always", "never") or 1 < count < samples / LEAST_SHARE:
        return ()
    if count == 1:
        message = f"the {'step' if terms.step else 'run'} takes no time: it has one sample only"
    else:
        message = f"what it is about was there at {samples} of {count} samples"
    return (VerdictWarning(HARDLY_OBSERVED, message),)


def _is_undecided(terms: Terms, series: _Series) -> bool:
    """Whether what must never hold could still hold, within its time, after the window's end."""
    if terms.word != "never" or (terms.hold is None and terms.within is None):
        return False
    within = terms.within
    if within is None:
        within = float(series.times[-1] - series.times[0])
    return not series.holds_after(replace(terms, within=within), np.inf)


def _ended_before(terms: Terms, times: FloatArray) -> str:
    """Why a window leaves undecided what it does not contradict."""
    span = float(times[-1] - times[0])
    if terms.within is not None and terms.within > span:
        return f"the {span:.3f} s it is judged over end before the {terms.within:g} s of `within`"
    return (
        f"it holds when the {span:.3f} s end that it is judged over: a longer time, as after a"
        f" `wait`, decides whether it holds for {terms.hold:g} s"
    )


def _revealing(
    hold: float, values: FloatArray, times: FloatArray, progress: FloatArray | None, index: int
) -> tuple[int, float]:
    """Where the longest hold broke or began too late, and the time it lacks [s]; 0 of others."""
    known = np.where(np.isnan(values), -np.inf, values)
    spans = temporal.episodes(known >= 0)
    if not spans:
        return temporal.eventually(known, times, progress=progress).index, 0.0
    start, stop = max(spans, key=lambda span: times[span[1] - 1] - times[span[0]])
    edge, lacks = stop if stop < len(times) else start - 1, hold - times[stop - 1] + times[start]
    return (edge, float(lacks)) if lacks > 0 and np.isfinite(known[edge]) else (index, 0.0)


def too_short(terms: Terms, times: FloatArray) -> Verdict:
    """The verdict where no sample leaves room for the required time."""
    hold, span = terms.hold or 0.0, float(times[-1] - times[0])
    reason = f"judged over {span:.3f} s, which leaves no room for {hold:.3f} s"
    if terms.within is not None:
        reason += f" begun within {terms.within:.3f} s"
    if terms.word == "never":
        raise NotReached(reason)
    return Verdict("", "failed", span - hold, "s", float(times[-1]), reason=reason)


def _held(terms: Terms, values: FloatArray, times: FloatArray, decision: Decision) -> str:
    """How long it held at most, where a time was required and was not reached."""
    if terms.hold is None or terms.word == "never" or decision.holds:
        return ""
    longest = longest_hold(np.nan_to_num(values, nan=-1.0), times)
    if longest >= terms.hold:
        return f". It was true for {amount(terms.hold, 's')}, but not in the required time"
    held, required = amounts(longest, terms.hold, "s")
    return f". It was true for {held} at a time at most, and `for` requires {required}"
