"""From a recorded run and what was expected to verdicts, and nothing else is needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.assertions import (
    clearance,
    collision,
    contact,
    fraction,
    grasp,
    inside,
    joints,
    lifted,
    limits,
    objects,
    sees,
    tcp,
    tcp_path,
    timing,
)
from harness.assertions.formula import formula_verdict
from harness.assertions.placed import PlacedExpectation
from harness.assertions.recorded import guarded
from harness.assertions.registry import signal
from harness.assertions.until import until_verdict
from harness.assertions.window import NotObservable, NotReached, window_of
from harness.assertions.wording import describe
from harness.assertions.words import WORDS, decide, terms_of
from harness.recording.run import Run, Verdict
from harness.spec.checks import AnyExpectation, AnyPredicate, Formula, Until

HANDLERS = (
    *(clearance, collision, contact, fraction, grasp, inside, joints, lifted, limits, objects),
    *(sees, tcp, tcp_path, timing),
)
TEMPORAL = (*WORDS, Until)
EXECUTED: frozenset[type] = frozenset(signal) | frozenset((*TEMPORAL, Formula))
"""Models that can be judged; compile refuses the others with "not yet available"."""


def judge(run: Run, expectations: Sequence[PlacedExpectation]) -> tuple[Verdict, ...]:
    """A verdict for each expectation, in their order."""
    readable = guarded(run)
    return tuple(_judge(readable, expectation) for expectation in expectations)


def _judge(run: Run, placed: PlacedExpectation) -> Verdict:
    text = describe(placed.spec)
    try:
        with np.errstate(invalid="ignore"):
            verdict = _verdict(run, placed.spec, placed.step)
    except NotReached as answer:
        verdict = Verdict(text, "not reached", reason=str(answer))
    except NotObservable as answer:
        verdict = Verdict(text, "not observable", reason=str(answer))
    points = points_of(placed.spec)
    return replace(verdict, expectation=text, line=placed.line, step=placed.step, points=points)


def points_of(spec: AnyExpectation) -> float | None:
    """What an expectation is worth in a graded scenario; None where it says nothing of it."""
    for model in (spec, getattr(spec, "predicate", None)):
        points = getattr(model, "points", None)
        if points is not None:
            return float(points)
    return None


def _verdict(run: Run, spec: AnyExpectation, step: str) -> Verdict:
    """What an expectation came to, without its place in the file.

    Raises:
        NotReached: There was nothing to judge.
        NotObservable: The record lacks what it is about, or it cannot be judged yet.
    """
    match spec:
        case Formula():
            return formula_verdict(spec.formula, window_of(run, spec.during or step))
        case Until(predicate=first, until=second):
            _refuse_unavailable(first, second)
            return until_verdict(spec, run, step)
        case _:
            terms = terms_of(spec, step)
            _refuse_unavailable(terms.predicate)
            window = window_of(run, terms.step)
            return decide(terms, window, signal(terms.predicate, window))


def _refuse_unavailable(*predicates: AnyPredicate) -> None:
    for predicate in predicates:
        if type(predicate) not in EXECUTED:
            raise NotObservable(f"`{predicate.check}` is not yet available")
