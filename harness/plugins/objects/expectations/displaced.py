"""displaced: the object is away from where it started."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.core.amounts import amount
from harness.judging.body_motion import middles
from harness.judging.expectation import ObjectPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import physical_poses, start_poses
from harness.judging.window import Window, object_record
from harness.language.base import PositiveLength
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

DISTANCE = Quantity("distance from the start", "m", "at least `at_least`")


class Displaced(ObjectPredicate):
    """The object is away from where it started, by the place of its centre of mass.

    A turn about that point is none: `upright` and the formula `tilt` measure it.
    """

    sentence = "{object} is displaced[ by at least {at_least}]"
    synonyms = ("moved", "pushed")
    quantities = (DISTANCE,)
    opposite = "static"
    is_change = True

    at_least: PositiveLength = Field(
        default=0.01, description="The smallest distance from its place at the start [m]."
    )

    def signal(self, window: Window) -> MarginSignal:
        """Distance of its middle from where that started [m]."""
        run, name = window.run, self.object
        record = object_record(run, name)
        now = middles(record, physical_poses(run, name))
        away = np.linalg.norm(now - middles(record, start_poses(run, name)), axis=1)
        part = Part(DISTANCE, window.cut(away), self.at_least, ">=", detail=name)

        def text(_: int, measure: Measure) -> str:
            return f"{name} is {amount(measure.value, 'm')} from its start"

        return all_of(window, [part], text)
