"""duration: simulated seconds of a step or of the run."""

from __future__ import annotations

import numpy as np

from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.window import NotReached, Window
from harness.core.quantity import distinct
from harness.recording.run import Measure
from harness.spec.checks import DurationCheck


@signal.handles(DurationCheck)
def duration(check: DurationCheck, window: Window) -> MarginSignal:
    """Time from the start to the end of the window's step, or of the run [s].

    Raises:
        NotReached: The step failed, or the run ended early: that is no duration.
    """
    run, step = window.run, window.step
    if step is not None:
        if step.status == "failed":
            raise NotReached(f"step '{step.id}' failed before its end")
        seconds = step.end_time - step.start_time
    else:
        if run.ended_early:
            raise NotReached(f"the run ended early: {run.ended_early}")
        first = min([window.time(0), *(step.start_time for step in run.steps)])
        seconds = window.time(len(window.times) - 1) - first
    values = np.full(len(window.times), round(seconds, 9))  # times are multiples of the time step
    parts: list[Part] = []
    if check.at_most is not None:
        parts.append(Part("duration", values, check.at_most, "<=", "s"))
    if check.at_least is not None:
        parts.append(Part("duration", values, check.at_least, ">=", "s"))

    def text(_: int, measure: Measure) -> str:
        bound = "at most" if measure.comparison == "<=" else "at least"
        took, limit = distinct(
            measure.value, measure.limit, lambda seconds, more: f"{seconds:.{3 + more}f} s"
        )
        return f"took {took}, {bound} {limit}"

    return all_of(window, parts, text, is_moment=False)
