"""lifted: the object is higher than at the start and nothing but the gripper holds it up."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount, amounts
from harness.core.types import BoolArray
from harness.judging.body_motion import lowest_points
from harness.judging.contacts import (
    TOUCH_FORCE,
    bodies_touching,
    side_forces,
    side_words,
    why_unsealed,
)
from harness.judging.expectation import ArmPredicate, ObjectPredicate
from harness.judging.hands import gripper_of, hand_links
from harness.judging.hold import (
    CARRIED_SHARE,
    HOLD_TIME,
    STEADY,
    STEADY_TURN,
    carried_weight,
    cradled,
    held_by_fingers,
    held_for,
    moves_in_hand,
    raised_by_hand,
    weight_of,
    weld_note,
)
from harness.judging.margins import Evidence, MarginSignal, measured
from harness.judging.poses import object_poses, present, start_poses
from harness.judging.support import SINKING, riders
from harness.judging.temporal import TIME_RESOLUTION
from harness.judging.window import Window, object_record
from harness.language.base import Flag, PositiveLength
from harness.language.expectation import Quantity
from harness.recording.run import Run
from harness.recording.verdict import Measure

HEIGHT = Quantity(
    "height gained", "m", "at least `above`; counts for nothing where another fails", "height"
)
FINGERS = Quantity(
    "finger force", "N", "at least 0.001 N on every side, from opposite sides", "contact"
)
OTHERS = Quantity(
    "other contact", "N", "at most 0.001 N, but with the gripper and what rests on it", "contact"
)
HELD = Quantity("time held", "s", "at least 0.1 s without a break")
CARRIED = Quantity("weight carried", "N", "by the hand, friction included: at least half of it")
MOTION = Quantity("motion in the hand", "m", "within 0.1 s at most 5 mm, and 0.1 rad of turn")


class Lifted(ArmPredicate, ObjectPredicate):
    """The gripper has raised the object, and nothing but the gripper holds it up.

    A lift is a hold in the balance of forces: both finger sides have pressed the object from
    opposite sides for 0.1 s, as `grasped` defines it; on average over that time the hand carries at
    least half of its weight, friction included; and within it the object moves in the hand by at
    most 5 mm and 0.1 rad. What is struck, bounces, or is thrown through the open hand fails one of
    them. The height is that of the object's lowest point above where it was at the start, as far as
    the motion of the hand has given it since the hold began. An object that lies on fingers that do
    not press it is not lifted unless `cradled` says so.
    """

    judged = "eventually"
    sentence = "{object} is lifted[ by at least {above}]"
    quantities = (HEIGHT, FINGERS, OTHERS, HELD, CARRIED, MOTION)
    is_change = True
    needs_touch = True

    above: PositiveLength = Field(
        default=0.01, description="The height of its lowest point above that at its own start [m]."
    )
    cradled: Flag = Field(
        default=False,
        description="Whether an object counts that lies on the fingers without being gripped.",
    )

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`lifted`")
        super().check(at)

    def signal(self, window: Window) -> MarginSignal:
        """Height that the hand raised the object above its start, less the required height [m].

        Where the gripper does not hold it, or anything but the gripper and what rests on it touches
        it, its height counts for nothing: the margin there is `-above`, less if it has sunk by more
        than a soft contact gives way.
        """
        run, name = window.run, self.object
        gripper = gripper_of(run)
        hand = hand_links(gripper)
        record = object_record(run, name)
        rise = lowest_points(record, object_poses(run, name))
        rise -= lowest_points(record, start_poses(run, name))
        sides = side_forces(run, name)
        loads = riders(run, name)
        others = {
            body: np.where(loads.get(body, False), 0.0, force)
            for body, force in bodies_touching(run, name, but=hand).items()
        }
        unknown = ~present(run, name)
        for force in others.values():
            unknown |= np.isnan(force)
        hold = _Hold(run, name, cradled_too=self.cradled)
        untouched = ~np.any([np.zeros(len(rise)), *(f > TOUCH_FORCE for f in others.values())], 0)
        raised = np.where(hold.is_steady & untouched, np.minimum(rise, hold.raised), 0.0)
        counted = np.minimum(np.where(rise < -SINKING, rise, np.maximum(rise, 0.0)), raised)
        values = np.where(unknown, np.nan, counted - self.above)

        def evidence(index: int) -> Evidence:
            sample, time = window.start + index, window.time(index)
            gained = float(rise[sample])
            pressed = ", ".join(
                f"{side_words(side)} {amount(float(force[sample]), 'N')}"
                for side, force in sides.items()
            )
            carriers = [body for body, force in others.items() if force[sample] > TOUCH_FORCE]
            why, more = hold.flaw(sample, gained, time)
            if carriers:
                it = name if hold.held[sample] else f"{why}, and it"
                why = f"{it} touches {' and '.join(carriers)}"
            rose = " of ".join(amounts(gained, self.above, "m"))
            text = (
                f"{name} rose {rose}, but {why}: {pressed}" if why else f"lifted {rose}: {pressed}"
            )
            text += weld_note(run, name, sample)
            if not record.in_simulation:
                text += f"; {name} is not in the physics"
            measures = [measured(HEIGHT, gained, self.above, ">=", time, name), *more]
            measures += [
                measured(FINGERS, float(force[sample]), TOUCH_FORCE, ">=", time,
                         name=f"{side_words(side)} force")
                for side, force in sides.items()
            ]  # fmt: skip
            measures += [
                measured(OTHERS, float(others[body][sample]), TOUCH_FORCE, "<=", time, body)
                for body in carriers
            ]
            return Evidence(text, tuple(measures))

        held = np.where(raised > 0, 0.0, np.minimum(hold.duration, 1.0))
        progress = rise + SINKING * held  # of what was not raised its longest hold counts
        return MarginSignal(window.cut(values), "m", evidence, progress=window.cut(progress))


class _Hold:
    """Where the hand holds an object in the balance of forces, and how far it has raised it.

    Attributes:
        held: Samples at which the hand holds it, shape (N,).
        is_steady: Samples at which it is held for long enough, carried, and still in the hand.
        raised: Height that the hand gave it since it holds it [m], shape (N,).
    """

    def __init__(self, run: Run, name: str, *, cradled_too: bool) -> None:
        self._run, self._name = run, name
        self.held = _touched_by_hand(run, name) if cradled_too else held_by_fingers(run, name)
        self.duration = held_for(run, self.held)
        self._carried = carried_weight(run, name)
        self._least = CARRIED_SHARE * weight_of(run, name)
        self._moved, self._turned = moves_in_hand(run, name)
        self.raised = raised_by_hand(run, name, self.held)
        self.is_steady = self.held & (self.duration >= HOLD_TIME - TIME_RESOLUTION)
        self.is_steady &= (self._moved <= STEADY) & (self._turned <= STEADY_TURN)
        if self._carried is not None:
            self.is_steady &= self._carried >= self._least

    def flaw(self, sample: int, gained: float, time: float) -> tuple[str, list[Measure]]:
        """Why the height of a sample does not count, or not all of it; empty where it does."""
        name = self._name
        if not self.held[sample]:
            lies = cradled(self._run, name)[sample]
            return f"{name} lies on the fingers, which do not press it" if lies else (
                f"nothing holds {name}{_seal(self._run, name, sample)}"
            ), []
        duration, moved = float(self.duration[sample]), float(self._moved[sample])
        if duration < HOLD_TIME - TIME_RESOLUTION:
            pressed, least = amounts(duration, HOLD_TIME, "s")
            return f"pressed for {pressed} so far, a grasp takes {least}", [
                measured(HELD, duration, HOLD_TIME, ">=", time, name)
            ]
        if self._carried is not None and self._carried[sample] < self._least:
            carried = float(self._carried[sample])
            shown = " of ".join(amounts(carried, 2 * self._least, "N"))
            return f"the hand carries {shown}", [
                measured(CARRIED, carried, self._least, ">=", time, name)
            ]
        if not self.is_steady[sample]:
            turned = amount(float(self._turned[sample]), "rad")
            text = f"{name} moved {amount(moved, 'm')} and turned {turned} in the hand within 0.1 s"
            return text, [measured(MOTION, moved, STEADY, "<=", time, name)]
        raised = float(self.raised[sample])
        if raised < gained - STEADY:
            return f"the hand raised it by {amount(raised, 'm')}", []
        return "", []


def _seal(run: Run, name: str, sample: int) -> str:
    """Why suction cups do not hold an object, as the end of a sentence."""
    why = why_unsealed(run, name, sample)
    return f": {why}" if why else ""


def _touched_by_hand(run: Run, name: str) -> BoolArray:
    """Samples at which every finger side touches an object, wherever, shape (N,)."""
    return np.min(list(side_forces(run, name).values()), axis=0) >= TOUCH_FORCE
