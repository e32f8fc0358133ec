"""duration: simulated seconds of a step or of the run."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.core.quantity import distinct
from harness.judging.expectation import Predicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotReached, Window
from harness.language.base import PositiveDuration
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

DURATION = Quantity("duration", "s", "at most `at_most`, at least `at_least`")


class DurationCheck(Predicate):
    """The step, or the run, takes at most or at least a given simulated time."""

    word = "duration"
    short = "at_most"
    synonyms = ("time", "max_time", "max_duration")
    some_of = ("at_most", "at_least")
    sentence = "duration is[ at least {at_least}][ at most {at_most}]"
    quantities = (DURATION,)

    at_most: PositiveDuration | None = Field(
        default=None,
        description="The longest simulated time that the step or the run may take [s].",
    )
    at_least: PositiveDuration | None = Field(
        default=None,
        description="The shortest simulated time that the step or the run may take [s].",
    )

    def signal(self, window: Window) -> MarginSignal:
        """Time from the start to the end of the window's step, or of the run [s].

        Raises:
            NotReached: The step failed, or the run ended early: that is no duration.
        """
        run, step = window.run, window.step
        if step is not None:
            if step.status == "failed":
                raise NotReached(f"step '{step.title}' failed before its end")
            seconds = step.end_time - step.start_time
        else:
            if run.ended_early:
                raise NotReached(f"the run ended early: {run.ended_early}")
            first = min([window.time(0), *(step.start_time for step in run.steps)])
            seconds = window.time(len(window.times) - 1) - first
        values = np.full(len(window.times), round(seconds, 9))  # times are multiples of the step
        parts: list[Part] = []
        if self.at_most is not None:
            parts.append(Part(DURATION, values, self.at_most, "<="))
        if self.at_least is not None:
            parts.append(Part(DURATION, values, self.at_least, ">="))

        def text(_: int, measure: Measure) -> str:
            bound = "at most" if measure.comparison == "<=" else "at least"
            took, limit = distinct(
                measure.value, measure.limit, lambda seconds, more: f"{seconds:.{3 + more}f} s"
            )
            return f"took {took}, {bound} {limit}"

        return all_of(window, parts, text, is_moment=False)
