"""upright: the object's z axis points up."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amounts, is_exact
from harness.core.pose_arrays import angle_between, rotate
from harness.judging.expectation import ObjectPredicate
from harness.judging.limits import lean_range, refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import UP, physical_poses
from harness.judging.window import Window
from harness.language.base import Angle
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

LEAN = Quantity("lean", "rad", "at most `tolerance`")


class Upright(ObjectPredicate):
    """The object's z axis points up."""

    sentence = "{object} is upright"
    quantities = (LEAN,)
    is_proposed = True

    tolerance: Annotated[Angle, Field(gt=0, lt=math.pi)] = Field(
        default=0.1, description="The largest angle between its z axis and the vertical [rad]."
    )

    def check(self, at: At) -> None:
        super().check(at)
        if (part := at.scope.objects.get(self.object)) is not None and part.joint is not None:
            ends, of = lean_range(part.joint), "the lean, by the joint,"
            refuse_decided(at, "tolerance", "<=", self.tolerance, ends, of)

    def looks_back(self) -> float:
        return 0.0

    def signal(self, window: Window) -> MarginSignal:
        """Angle of the object's z axis to the vertical [rad]."""
        lean = angle_between(rotate(physical_poses(window.run, self.object)[:, 3:], UP), UP)
        part = Part(LEAN, window.cut(lean), self.tolerance, "<=", detail=self.object)

        def text(_: int, measure: Measure) -> str:
            if is_exact(measure.value, measure.limit, "rad"):
                return f"{self.object} stands exactly upright"
            leans = " of ".join(amounts(measure.value, measure.limit, "rad"))
            return f"{self.object} leans by {leans}"

        return all_of(window, [part], text)
