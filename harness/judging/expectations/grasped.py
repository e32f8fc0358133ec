"""grasped: both finger sides hold the object between them and it moves with the gripper."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount, amounts
from harness.judging.contacts import (
    TOUCH_FORCE,
    attached,
    side_forces,
    side_words,
    why_unsealed,
)
from harness.judging.expectation import ArmPredicate, ObjectPredicate
from harness.judging.hold import (
    HOLD_TIME,
    between_fingers,
    cradled,
    held_by_fingers,
    held_for,
    moved_since,
    weld_note,
    why_not_between,
)
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import present
from harness.judging.temporal import TIME_RESOLUTION, episodes
from harness.judging.window import Window, object_record
from harness.language.base import AngleBetween, Deviation, Force
from harness.language.expectation import Quantity
from harness.recording.run import Run
from harness.recording.verdict import Measure

FINGERS = Quantity("finger force", "N", "at least `min_force` on every side", "contact")
BETWEEN = Quantity(
    "between the fingers", "1", "free, and pressed from opposite sides by fingers that close"
)
HELD = Quantity("time held", "s", "at least 0.1 s without a break")
SLIP = Quantity("slip in the hand", "m", "between the fingers at most `max_slip`", "slip")
TURN = Quantity("turn in the hand", "rad", "at most `max_rotation`", "slip")


class Grasped(ArmPredicate, ObjectPredicate):
    """Both finger sides hold the object between them and it moves with the gripper.

    It is between the fingers where two sides press it from opposite directions, more than 90
    degrees apart, at places as far from each other as the object is thick: two contacts with
    coefficients of friction of at most 1 can only then balance each other. Closed tips on a larger
    box are not, nor is what lies on fingers that do not press it, nor what is fixed in the world.
    Fingers may also spread inside a ring. The object slips as its point between the fingers does,
    wherever its origin is. A grasp has lasted for 0.1 s: a blow
    lasts a few milliseconds, and what flies past at 0.5 m/s is 5 cm further by then.
    """

    sentence = "{object} is grasped"
    quantities = (FINGERS, BETWEEN, HELD, SLIP, TURN)
    is_proposed = True
    synonyms = ("held", "holding", "picked", "gripped")
    opposite = "released"
    needs_touch = True

    min_force: Annotated[Force, Field(ge=0)] = Field(
        default=0.05, description="The smallest force on each side [N]."
    )
    max_slip: Deviation = Field(
        default=0.005,
        description="The largest distance moved in the hand since the grasp began [m].",
    )
    max_rotation: Annotated[AngleBetween, Field(ge=0)] = Field(
        default=0.1, description="The largest rotation in the hand since the grasp began [rad]."
    )

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`grasped`")
        super().check(at)

    def signal(self, window: Window) -> MarginSignal:
        """Force on each side, and drift in the hand since all sides have held without a break.

        Drift is that of the object's point between the fingers since the first sample of the
        current grasp; every turn counts, also about the axis of a round object.
        """
        run, name = window.run, self.object
        min_force = max(self.min_force, TOUCH_FORCE)
        is_free = not object_record(run, name).is_static
        in_hand = held_by_fingers(run, name, min_force) & is_free
        since = np.zeros(len(in_hand), dtype=int)
        for start, stop in episodes(in_hand):
            since[start:stop] = start
        distance, turn = (window.cut(each) for each in moved_since(run, name, since))
        relevant = window.cut(in_hand)
        sides = {side: window.cut(force) for side, force in side_forces(run, name).items()}
        parts = [
            Part(FINGERS, force, min_force, ">=", measured_name=f"{side_words(side)} force")
            for side, force in sides.items()
        ]
        slip = [
            Part(SLIP, distance, self.max_slip, "<=", relevant=relevant),
            Part(TURN, turn, self.max_rotation, "<=", relevant=relevant),
        ]
        between = between_fingers(run, name) & ~cradled(run, name) & is_free
        touched = np.min([part.margins() for part in parts], axis=0) >= 0
        duration = window.cut(held_for(run, in_hand))
        # by half of the limit: a gripper that has stalled holds for 0.15 s, and slip says more then
        parts += [
            Part(BETWEEN, window.cut(between).astype(float), 1.0, "==", relevant=touched),
            Part(HELD, duration + TIME_RESOLUTION, HOLD_TIME, ">=", HOLD_TIME / 2, relevant),
            *slip,
        ]

        def text(index: int, measure: Measure) -> str:
            forces = ", ".join(
                f"{side_words(side)} {amount(float(force[index]), 'N')}"
                for side, force in sides.items()
            )
            if relevant[index]:
                moved = amount(float(slip[0].values[index]), "m")
                turned = amount(float(slip[1].values[index]), "rad")
                drift = f"{name} moved {moved} and turned {turned} in the hand"
                brief = ""
                if measure.name == HELD.name and measure.value < measure.limit:
                    pressed, least = amounts(measure.value, HOLD_TIME, "s")
                    brief = f"; pressed for {pressed} so far, a grasp takes {least}"
                return f"{forces}; {drift}{brief}{weld_note(run, name, window.start + index)}"
            sample = window.start + index
            where = _where_pressed(run, name, sample)
            belief = _planners_belief(run, name, sample)
            if why := why_unsealed(run, name, sample):
                return f"{forces}; no suction cup holds {name}: {why}{belief}"
            return f"{forces}; {name} is not between the fingers{where}{belief}"

        return all_of(window, parts, text, present=window.cut(present(run, name)), shown=len(parts))


def _where_pressed(run: Run, name: str, sample: int) -> str:
    """A note on fingers that touch an object and do not have it between them."""
    if min(force[sample] for force in side_forces(run, name).values()) < TOUCH_FORCE:
        return ""
    if object_record(run, name).is_static:
        return ", it is fixed in the world"
    why = why_not_between(run, name, sample)
    return f", {why}" if why else ""


def _planners_belief(run: Run, name: str, sample: int) -> str:
    """What the planning scene assumed of an object that the physics does not hold."""
    if not object_record(run, name).in_simulation:
        stands_for = [
            record.represents
            for record in run.attachments
            if record.object == name and record.represents != name
        ]
        hint = f": it stands for {stands_for[0]}" if stands_for else ""
        return f", it is not in the physics{hint}"
    if attached(run, name)[sample]:
        return ", though the planning scene has it attached"
    return ""
