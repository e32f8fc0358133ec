"""gripper: GripperCommand."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.grasping import GAP_SLACK, position_for_width
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.amounts import JointUnits, amounts, joint_position
from harness.core.errors import StepFailed
from harness.core.state_words import stated_name
from harness.language.base import JointEffort, JointValue, Name, NonNegativeLength
from harness.ports.simulation import GripperResult
from harness.recording.execution_failures import GripperOutcome

DEFAULT_TIMEOUT = 10.0  # [s] of simulation


class Gripper(Step):
    """Move the gripper to a named state, a `position` or a `width`: ROS's GripperCommand."""

    short = "named_target"
    one_of = ("named_target", "position", "width")

    verb: ClassVar[str] = "gripper"
    plans: ClassVar[bool] = False
    synonyms = ("open_gripper", "close_gripper", "hand")
    moves_gripper: ClassVar[bool] = True
    keeps_arm_still: ClassVar[bool] = True
    results = (GripperOutcome,)

    named_target: Name | None = Field(
        default=None, description="The gripper moves to this SRDF group state."
    )
    position: JointValue | None = Field(
        default=None, description="The gripper's joint moves to this position."
    )
    width: NonNegativeLength | None = Field(
        default=None, description="The gap between the pads becomes this wide [m]."
    )
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None,
        description="The effort limit of the gripper's joint; the default is the robot's.",
    )

    def summary_in(self, units: JointUnits) -> str:
        if self.named_target is not None:
            return self.named_target
        if self.position is not None:
            return f"to {joint_position(self.position, units.gripper)}"
        return f"width {joint_position(self.width or 0.0, 'm')}"

    def check(self, at: At) -> None:
        if not at.scope.check_gripper(at.loc, "`gripper`"):
            return
        hand = at.scope.description.gripper
        if hand is not None and self.named_target is not None:
            at.scope.check_state(hand.group, self.named_target, at.key("named_target"))
        check_gripper_position(self.position, at)
        _check_gripper_width(self.width, at)

    def execute(self, cell: Cell) -> None:
        """Drive the gripper's joint until it arrives or stalls; a stall is no failure, as in ROS.

        Raises:
            StepFailed: TIMED_OUT, when it does neither in time.
        """
        hand = cell.gripper
        target, effort = self.command(cell)
        timeout = self.timeout or DEFAULT_TIMEOUT
        result = cell.simulator.command_gripper(target, effort, timeout=timeout, joint=hand.joint)
        note_result(cell, target, result)
        if not (result.reached_goal or result.stalled):
            unit = cell.description.joint_units.gripper
            is_at, goal = amounts(result.position, target, unit)
            raise StepFailed(
                "TIMED_OUT",
                f"'{hand.joint}' is at {is_at} and still moves towards {goal} after {timeout:g} s",
            )

    def command(self, cell: Cell) -> tuple[float, float]:
        """GripperCommand's position and max_effort."""
        hand = cell.gripper
        effort = self.max_effort or hand.grip_effort
        if self.named_target is not None:
            states = cell.description.states_of(hand.group)
            return states[stated_name(self.named_target, states)].positions[hand.joint], effort
        if self.position is not None:
            return self.position, effort
        return position_for_width(hand, self.width or 0.0), effort


def check_gripper_position(position: float | None, at: At) -> None:
    """Report a position outside the limits of the gripper's joint."""
    hand = at.scope.description.gripper
    if position is None or hand is None:
        return
    joint = at.scope.description.joint_by_name[hand.joint]
    at.scope.check_joint_unit(hand.joint, at.key("position"))
    if not joint.lower <= position <= joint.upper:
        *limits, stated = (
            joint_position(each, joint.position_unit)
            for each in (joint.lower, joint.upper, position)
        )
        at.scope.problems.add(
            at.key("position"),
            f"'{joint.name}' goes from {' to '.join(limits)}, not to {stated}",
        )


def _check_gripper_width(width: float | None, at: At) -> None:
    """Report a gap that the gripper's table of widths does not reach."""
    hand = at.scope.description.gripper
    if width is None or hand is None:
        return
    if hand.cups:
        at.scope.problems.add(
            at.key("width"), "suction cups have no width", "write `gripper: on` or `gripper: off`"
        )
        return
    narrowest, widest = hand.widths[:, 1].min(), hand.widths[:, 1].max()
    if not narrowest - GAP_SLACK <= width <= widest + GAP_SLACK:
        at.scope.problems.add(
            at.key("width"),
            f"the gap between the pads goes from {1e3 * narrowest:.1f} to {1e3 * widest:.1f} mm,"
            f" not to {1e3 * width:.1f} mm",
        )


def note_result(cell: Cell, target: float, result: GripperResult) -> GripperOutcome:
    """Leave GripperCommand's result, and the contacts, in the step's record."""
    outcome = GripperOutcome(
        target=target,
        position=result.position,
        effort=result.effort,
        stalled=result.stalled,
        reached_goal=result.reached_goal,
        contacts=result.contacts,
    )
    cell.report(outcome)
    return outcome
