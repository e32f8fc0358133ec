"""until: one predicate holds at every sample before the one at which another becomes true."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from pydantic import Field, model_validator

from harness.core.amounts import amount
from harness.core.types import FloatArray
from harness.judging import temporal
from harness.judging.expectation import InnerPredicate, Predicate, TemporalWord
from harness.judging.margins import MarginSignal
from harness.judging.temporal import TIME_RESOLUTION, Decision, TooShort, longest_hold
from harness.judging.window import NotObservable, NotReached, Window, window_of
from harness.judging.words import ALREADY_TRUE, terms_of, too_short
from harness.recording.run import Run
from harness.recording.verdict import Observed, Verdict, VerdictStatus, VerdictWarning


class Until(TemporalWord):
    """The first predicate holds until the second does, and the second does."""

    until: InnerPredicate = Field(description="The predicate that must become true.")

    @model_validator(mode="after")
    def _check_words(self) -> Until:
        if self.predicate.for_ is not None or self.predicate.within is not None:
            raise ValueError(
                "what holds until then has no `for` and no `within`; write them inside `until:`"
            )
        return self

    def predicates(self) -> Mapping[str, Predicate]:
        return {"predicate": self.predicate, "until": self.until}

    def verdict(self, run: Run, step: str) -> Verdict:
        """The verdict, without its text and its place in the file.

        Margins of two kinds are compared as SI numbers, as signal temporal logic does; the one that
        decides is reported in its own unit.

        Raises:
            NotReached: One of the two was never there.
            NotObservable: The record lacks what they are about.
        """
        terms = terms_of("until", [self, self.predicate, self.until], step, is_opposed=False)
        window = window_of(run, terms.step)
        times, hold = window.times, terms.hold
        first, second = self.predicate.margins(window), self.until.margins(window)
        low = [_low(margins, skipped) for margins, skipped in ((first, np.inf), (second, -np.inf))]
        unknown = first.unknown() | second.unknown()

        def decide(margins: list[FloatArray], times: FloatArray) -> tuple[Decision, bool]:
            first, second = margins
            return until_decision(first, second, times, hold, terms.within)

        future = [temporal.with_future(margins, np.inf) for margins in low]
        is_open = bool(window.cut_short) and decide(future, temporal.later(times))[0].holds
        try:
            decision, is_second = decide(low, times)
        except TooShort:
            if is_open:
                raise NotReached(window.cut_short) from None
            return too_short(terms, times)
        if not decision.holds:
            if is_open:
                raise NotReached(window.cut_short)
            best = [
                np.where(m.unknown(), np.inf, v) for m, v in zip((first, second), low, strict=True)
            ]
            if decide(best, times)[0].holds:
                count = int(unknown.sum())
                raise NotObservable(f"{count} samples are not known, and would decide it")
        margins = second if is_second else first
        answer = self._worded(window, margins, decision, hold if is_second else None, is_second)
        return replace(
            answer,
            observed=Observed(int((~unknown).sum()), int(unknown.sum())),
            warnings=self._came_at_once(low[1], window, hold) if decision.holds else (),
        )

    def _came_at_once(
        self, second: FloatArray, window: Window, hold: float | None
    ) -> tuple[VerdictWarning, ...]:
        """A warning where the second holds from the first sample on: the first was not judged."""
        held = longest_hold(second, window.times, is_first=True)
        if second[0] < 0 or held < (hold or 0.0) - TIME_RESOLUTION:
            return ()
        message = (
            f"`{self.until.word}` held at t={window.time(0):.3f} s, the first sample, so that"
            f" `{self.predicate.word}` was judged at none"
        )
        return (VerdictWarning(ALREADY_TRUE, message),)

    def _worded(
        self,
        window: Window,
        margins: MarginSignal,
        decision: Decision,
        hold: float | None,
        is_second: bool,
    ) -> Verdict:
        word = self.until.word if is_second else self.predicate.word
        time = window.time(decision.index)
        status: VerdictStatus = "passed" if decision.holds else "failed"
        if not math.isfinite(decision.value):
            if decision.holds:
                raise NotReached(f"{word} was not there before")
            reason = f"{word} is not known, or not there, at t={time:.3f} s"
            return Verdict("", status, time=time, reason=reason)
        evidence = margins.evidence(decision.index)
        margin, unit = decision.value, margins.unit
        if evidence.margin is not None:
            margin, unit = evidence.margin, evidence.unit
        at = f" at t={time:.3f} s" if evidence.is_moment else ""
        role = "came" if is_second else "held before it"
        if not decision.holds:
            role = "never came" if is_second else "did not hold until then"
        lasting = "" if hold is None else f" for {amount(hold, 's')}"
        reason = f"`{word}` {role}{lasting}: {evidence.text}{at}"
        measures = evidence.measures
        return Verdict("", status, margin + 0.0, unit, time, reason=reason, measures=measures)


def _low(margins: MarginSignal, skipped: float) -> FloatArray:
    """Margins with unknown samples counted against the expectation.

    Args:
        skipped: What counts where the predicate does not apply: before an object is there, nothing
            is required of it, and nothing becomes true.

    Raises:
        NotReached: It never applies.
    """
    values = np.where(np.isnan(margins.values), -np.inf, margins.values)
    if margins.applies is not None:
        values = np.where(margins.applies, values, skipped)
    if not np.isfinite(values).any():
        raise NotReached("what it is about was not there in the time it is judged over")
    return values


def until_decision(
    first: FloatArray,
    second: FloatArray,
    times: FloatArray,
    hold: float | None = None,
    within: float | None = None,
) -> tuple[Decision, bool]:
    """The best moment at which the second begins, the first having held at all samples before it.

    At that moment itself the first need not hold.

    Args:
        first: Margins of what must hold before, shape (n,), n > 0, without NaN.
        second: Margins of what must come, shape (n,), without NaN.
        hold: The second must be held so long without a break [s].
        within: Latest beginning of the second after the first sample [s].

    Returns:
        The decision, and whether it was a sample of the second that decided.

    Raises:
        TooShort: No sample at which the second may begin is followed by `hold` seconds.
    """
    starts, ends = temporal.spans(times, hold, within)
    coming = temporal.range_min(second, starts, ends)
    before = np.concatenate([[np.inf], np.minimum.accumulate(first)])[starts]
    values = np.minimum(coming, before)
    came = coming >= 0
    if came.any() and not (values >= 0).any():  # it came: what did not hold before says why
        values = np.where(came, values, -np.inf)
    best = int(np.argmax(values))
    value, is_second = float(values[best]), bool(coming[best] <= before[best])
    start, end = int(starts[best]), int(ends[best])
    if is_second:
        index = start + int(np.argmin(second[start : end + 1]))
    else:
        index = int(np.argmin(first[:start]))
    return Decision(value, index, bool(value >= 0)), is_second
