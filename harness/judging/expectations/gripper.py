"""gripper: the gripper stands at a named state, a position or a width, or is stalled."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amounts
from harness.core.state_words import stated_name
from harness.judging.contacts import finger_gap
from harness.judging.expectation import ArmPredicate, Mechanisms
from harness.judging.hands import gripper_of
from harness.judging.joints import POSITION_ERROR, SLIDING_TOLERANCE, check_tolerance, near
from harness.judging.limits import error_range, refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotObservable, NotReached, Window, refuse_unrecorded_steps
from harness.language.base import Flag, JointValue, Name, NonNegativeLength
from harness.language.expectation import Quantity
from harness.recording.execution_failures import GripperOutcome
from harness.recording.verdict import Measure

GAP = Quantity("gap error", "m", "with `width`: at most `tolerance`, 2 mm if not given")
STALLED = Quantity("stalled", "1", "as `stalled` says")


class GripperState(ArmPredicate):
    """The gripper stands at a named state, a position or a width, or is stalled."""

    word = "gripper"
    short = "named_target"
    one_of = ("named_target", "position", "width", "stalled")
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "tolerance": ("named_target", "position", "width")
    }
    sentence = "gripper is[ {named_target}][ at {position}][ open by {width}][ {stalled}]"
    quantities = (POSITION_ERROR, GAP, STALLED)
    is_proposed = True

    named_target: Name | None = Field(
        default=None, description="The name of an SRDF group state of the gripper."
    )
    position: JointValue | None = Field(
        default=None, description="The position of the gripper's joint."
    )
    width: NonNegativeLength | None = Field(
        default=None, description="The gap between the pads [m]."
    )
    tolerance: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.02,
        description="The tolerance of the joint or of the width; by default 0.02 rad, and 2 mm of a"
        " width and where the joint slides.",
    )
    stalled: Flag | None = Field(
        default=None, description="Whether the last gripper step reported that it stalled."
    )

    def unit_of(self, key: str) -> str:
        return "m" if key == "tolerance" and self.width is not None else super().unit_of(key)

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`gripper`")
        hand = at.scope.description.gripper
        if self.width is not None:
            at.scope.problems.check_unit(at.key("tolerance"), "m")
            if hand is not None:
                gaps, is_given = hand.widths[:, 1], "tolerance" in self.model_fields_set
                ends = error_range(self.width, float(gaps.min()), float(gaps.max()))
                limit = self.tolerance if is_given else SLIDING_TOLERANCE
                refuse_decided(at, "tolerance", "<=", limit, ends, "the error of the gap")
        elif hand is not None:
            for key in self.model_fields_set.intersection(("position", "tolerance")):
                at.scope.check_joint_unit(hand.joint, at.key(key))
        if self.position is not None and hand is not None:
            is_given = "tolerance" in self.model_fields_set
            check_tolerance(at, "position", {hand.joint: self.position}, self.tolerance, is_given)
        if self.named_target is not None and hand is not None:
            at.scope.check_state(hand.group, self.named_target, at.key("named_target"))

    def joint_units(self, mechanisms: Mechanisms) -> frozenset[str]:
        hand = mechanisms.robot.gripper
        return mechanisms.units_of([] if hand is None else [hand.joint])

    def names(self) -> frozenset[str]:
        return frozenset()

    def signal(self, window: Window) -> MarginSignal:
        """The gripper's joint, or the gap between its pads, or what its last step reported."""
        run = window.run
        hand = gripper_of(run)
        given = "tolerance" in self.model_fields_set
        if self.stalled is not None:
            return _stalled(self.stalled, window)
        if self.named_target is not None:
            states = run.robot.states_of(hand.group)
            state = states.get(stated_name(self.named_target, states))
            if state is None:
                raise NotObservable(f"there is no named state '{self.named_target}' of the gripper")
            return near(window, state.positions, self.tolerance, given)
        if self.position is not None:
            return near(window, {hand.joint: self.position}, self.tolerance, given)
        width = self.width or 0.0
        gap = window.cut(finger_gap(run))
        limit = self.tolerance if given else SLIDING_TOLERANCE
        part = Part(GAP, np.abs(gap - width), limit, "<=")

        def text(index: int, _: Measure) -> str:
            actual, required = amounts(float(gap[index]), width, "m")
            return f"the gap is {actual}, {required} required"

        return all_of(window, [part], text)


def _stalled(expected: bool, window: Window) -> MarginSignal:
    """What the last finished gripper step had reported by each sample."""
    run = window.run
    reported = np.full(len(run.signals.times), np.nan)
    for step in run.steps:
        outcome = step.result.find(GripperOutcome)
        is_of_arm = run.robot.selected_arm in ("", step.arm)
        if step.status != "not reached" and outcome is not None and is_of_arm:
            reported[max(step.end_index - 1, 0) :] = float(outcome.stalled)
    reported = window.cut(reported)
    if np.isnan(reported).all():
        refuse_unrecorded_steps(run)
        raise NotReached("no gripper step has reported yet")
    part = Part(STALLED, reported, float(expected), "==")

    def text(_: int, measure: Measure) -> str:
        return "the gripper stalled" if measure.value == 1 else "the gripper did not stall"

    return all_of(window, [part], text, present=~np.isnan(reported))
