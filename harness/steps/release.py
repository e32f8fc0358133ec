"""release: open, verify that nothing is held, detach in the planning scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.core.errors import StepFailed
from harness.core.state_words import stated_name
from harness.language.base import JointValue, Name
from harness.recording.execution_failures import GripperOutcome
from harness.steps.gripper import DEFAULT_TIMEOUT, note_result


@dataclass(frozen=True)
class Released(Detail):
    """The object that the gripper let go, by name."""

    released: str


class Release(Step):
    """Open, verify that nothing is held, detach in the planning scene."""

    short = "object"

    verb: ClassVar[str] = "release"
    plans: ClassVar[bool] = False
    moves_gripper: ClassVar[bool] = True
    keeps_arm_still: ClassVar[bool] = True
    detaches_object: ClassVar[bool] = True
    results = (GripperOutcome, Released)

    object: Name | None = Field(
        default=None,
        description="The name of the object; the default is the one that was grasped last.",
    )
    named_target: Name | None = Field(
        default=None,
        description="The gripper opens to this SRDF group state; the default is its open position.",
    )
    position: JointValue | None = Field(
        default=None,
        description="The gripper's joint opens to this position, in place of `named_target`.",
    )

    @model_validator(mode="after")
    def _one_target(self) -> Self:
        if self.named_target is not None and self.position is not None:
            raise ValueError("at most one of `named_target` and `position`")
        return self

    def summary(self) -> str:
        return self.object or ""

    def check(self, at: At) -> None:
        scope = at.scope
        hand = scope.description.gripper
        if scope.check_gripper(at.loc, "`release`") and hand and self.named_target:
            scope.check_state(hand.group, self.named_target, at.key("named_target"))
        if self.object is not None:
            scope.check_object(self.object, at.key("object"))
            scope.attached.pop(self.object, None)
        elif scope.attached:
            scope.attached.popitem()

    def execute(self, cell: Cell) -> None:
        """Open the gripper, detach the object, and verify that no finger touches it any more.

        Raises:
            StepFailed: INVALID_OBJECT_NAME, when nothing is held, or not that object;
                CONTROL_FAILED, when a finger still touches it.
        """
        hand = cell.gripper
        held = cell.held_objects
        name = self.object or (held[-1] if held else None)
        if name is None:
            message = "nothing was grasped, so nothing can be released"
            raise StepFailed("INVALID_OBJECT_NAME", message)
        refuse_other_holder(name, cell)
        target = hand.open_position
        if self.named_target is not None:
            states = cell.description.states_of(hand.group)
            target = states[stated_name(self.named_target, states)].positions[hand.joint]
        elif self.position is not None:
            target = self.position
        if not cell.is_carried_by_other(name):
            cell.unweld(name)
        result = cell.simulator.command_gripper(
            target,
            hand.max_effort,
            timeout=self.timeout or DEFAULT_TIMEOUT,
            joint=hand.joint,
        )
        note_result(cell, target, result)
        touching = [side for side, names in result.contacts.items() if name in names]
        if hand.cups:  # a rim may touch what it does not hold
            touching = list(result.between)
        if touching:
            sides = " and ".join(f"the {side} finger" for side in touching)
            message = f"{sides} still touches '{name}' with the gripper open"
            raise StepFailed("CONTROL_FAILED", message)
        cell.let_go(name)
        cell.report(Released(name))


def refuse_other_holder(name: str, cell: Cell) -> None:
    """Refuse an object that other arms hold, and the step's arm does not.

    Raises:
        StepFailed: INVALID_OBJECT_NAME.
    """
    holders, arm = cell.holders(name), cell.description.selected_arm
    if holders and arm not in holders:
        holder = " and ".join(holders)
        raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is held by {holder}, not by {arm}")
