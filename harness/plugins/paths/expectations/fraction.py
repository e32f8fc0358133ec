"""fraction: how much of their Cartesian paths the steps followed, as they reported it."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.core.amounts import percentages
from harness.judging.expectation import Predicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotReached, Window, refuse_unrecorded_steps
from harness.language.base import Fraction
from harness.language.expectation import Quantity
from harness.recording.step_results import CartesianPathResult
from harness.recording.verdict import Measure

FRACTION = Quantity("fraction", "1", "at least `at_least`, for each path")


class FractionCheck(Predicate):
    """Every `cartesian_path` of the window was followed to at least a given share."""

    word = "fraction"
    short = "at_least"
    sentence = "fraction of the path is at least {at_least}"
    quantities = (FRACTION,)

    at_least: Fraction = Field(
        default=1.0, description="The smallest share of each path that must be followed."
    )

    def signal(self, window: Window) -> MarginSignal:
        """The least share that a Cartesian path of the window had been followed by each sample.

        A step reports its share with its last sample; one that followed none of it reports 0.

        Raises:
            NotReached: No step of the window reported a share.
            NotObservable: The steps were not recorded.
        """
        run = window.run
        least = np.full(len(run.signals.times), np.inf)
        reporters = [
            (step, last, followed.fraction)
            for step in run.steps
            if step.status != "not reached"
            and (followed := step.result.find(CartesianPathResult)) is not None
            and window.start <= (last := max(step.end_index - 1, step.start_index)) < window.stop
        ]
        if not reporters:
            refuse_unrecorded_steps(run)
            raise NotReached("no step of it followed a Cartesian path")
        for _, last, share in reporters:
            least[last:] = np.minimum(least[last:], share)
        reported = window.cut(least)
        part = Part(FRACTION, reported, self.at_least, ">=", ceiling=1.0)

        def text(_: int, measure: Measure) -> str:
            worst = min(reporters, key=lambda reporter: reporter[2])[0]
            followed, required = percentages(measure.value, self.at_least)
            return f"{followed} of the path of {worst.id} followed, {required} required"

        return all_of(window, [part], text, present=np.isfinite(reported))
