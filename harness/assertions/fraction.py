"""fraction: how much of their Cartesian paths the steps followed, as they reported it."""

from __future__ import annotations

import numpy as np

from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.window import NotReached, Window, refuse_unrecorded_steps
from harness.recording.run import Measure
from harness.spec.checks import FractionCheck


@signal.handles(FractionCheck)
def fraction(check: FractionCheck, window: Window) -> MarginSignal:
    """The least share that a Cartesian path of the window had been followed by each sample.

    A step reports its share with its last sample; one that followed none of it reports 0.

    Raises:
        NotReached: No step of the window reported a share.
    """
    run = window.run
    least = np.full(len(run.signals.times), np.inf)
    reporters = [
        step
        for step in run.steps
        if step.status != "not_reached"
        and "fraction" in step.result
        and window.start <= max(step.end_index - 1, step.start_index) < window.stop
    ]
    if not reporters:
        refuse_unrecorded_steps(run)
        raise NotReached("no step of it followed a Cartesian path")
    for step in reporters:
        last = max(step.end_index - 1, step.start_index)
        least[last:] = np.minimum(least[last:], _share(step.result["fraction"]))
    reported = window.cut(least)
    part = Part("fraction", reported, check.at_least, ">=", "1")

    def text(_: int, measure: Measure) -> str:
        worst = min(reporters, key=lambda step: _share(step.result["fraction"]))
        asked = f"{100 * check.at_least:.1f} %"
        return f"{100 * measure.value:.1f} % of the path of {worst.id} followed, {asked} asked for"

    return all_of(window, [part], text, present=np.isfinite(reported))


def _share(value: object) -> float:
    """A reported share; what is no number is unknown."""
    return float(value) if isinstance(value, int | float) else float("nan")
