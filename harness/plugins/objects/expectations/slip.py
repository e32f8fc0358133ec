"""slip: a held object against where the planner believes it to be."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount
from harness.judging.drift import drift_in_hand
from harness.judging.expectation import ObjectPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import Window
from harness.language.base import AngleBetween, Deviation
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

SLIP = Quantity("slip against the planner", "m", "at most `max_distance`", "slip")
TURN = Quantity("turn against the planner", "rad", "at most `max_rotation`")


class Slip(ObjectPredicate):
    """A held object is where the planner believes it to be."""

    judged = "always"
    sentence = "slip of {object} is at most {max_distance}"
    quantities = (SLIP, TURN)
    is_upper_bound = True

    max_distance: Deviation = Field(
        default=0.003, description="The largest distance between the two [m]."
    )
    max_rotation: Annotated[AngleBetween, Field(gt=0)] = Field(
        default=0.05235987755982988,
        description="The largest rotation between the two; turns about the axis of a round object"
        " do not count [rad].",
    )

    def check(self, at: At) -> None:
        at.scope.check_object(self.object, at.key("object"))

    def signal(self, window: Window) -> MarginSignal:
        """How far an object has drifted from where the planner carries it.

        Judges the samples at which the planning scene has the object attached, from the first one
        at which all finger sides touch it until the gripper is opened to release it. What planner
        and physics differ by at the first (a planning object that `represents` another may be a
        little next to it) is the zero. Turns about the axis of a round object do not count.
        """
        run = window.run
        name, drift, turn, held = drift_in_hand(run, self.object)
        parts = [
            Part(SLIP, window.cut(drift), self.max_distance, "<="),
            Part(TURN, window.cut(turn), self.max_rotation, "<="),
        ]

        def text(index: int, _: Measure) -> str:
            moved, turned = (float(part.values[index]) for part in parts)
            return (
                f"{name} is {amount(moved, 'm')} and {amount(turned, 'rad')} from where the planner"
                " carries it"
            )

        return all_of(window, parts, text, applies=window.cut(held))
