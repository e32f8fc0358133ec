"""Judges a recorded run: a run and its expectations in, verdicts out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.judging.expectation import Expectation, Mechanisms
from harness.judging.facts import remembered_facts
from harness.judging.placed import PlacedExpectation, describe
from harness.judging.recorded import guard_unrecorded
from harness.judging.window import NotObservable, NotReached, refuse_changed_later
from harness.recording.run import Run
from harness.recording.verdict import Verdict


def judge(run: Run, expectations: Sequence[PlacedExpectation]) -> tuple[Verdict, ...]:
    """A verdict for each expectation, in their order."""
    readable = guard_unrecorded(run)
    mechanisms = Mechanisms.of(run.robot, run.objects)
    with remembered_facts():
        return tuple(_judge(readable, each, mechanisms) for each in expectations)


def _judge(run: Run, placed: PlacedExpectation, mechanisms: Mechanisms) -> Verdict:
    text = describe(placed.spec, mechanisms)
    try:
        refuse_changed_later(run, placed.step, placed.spec.names())
        with np.errstate(invalid="ignore"):
            verdict = placed.spec.verdict(placed.spec.readable(run), placed.step)
    except NotReached as answer:
        verdict = Verdict(text, "not reached", reason=str(answer))
    except NotObservable as answer:
        verdict = Verdict(text, "not observable", reason=str(answer))
    points = points_of(placed.spec)
    return replace(verdict, expectation=text, line=placed.line, step=placed.step, points=points)


def points_of(spec: Expectation) -> float | None:
    """The points of an expectation in a graded scenario; None where it states none."""
    for model in (spec, spec.predicates().get("predicate")):
        if model is not None and model.points is not None:
            return float(model.points)
    return None
