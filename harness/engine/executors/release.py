"""release: open, verify that nothing is held, detach in the planning scene."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.engine.executors.gripper import DEFAULT_TIMEOUT, note_result
from harness.engine.registry import execute
from harness.spec.steps import Release


@execute.handles(Release)
def release(step: Release, cell: Cell) -> None:
    """Open the gripper, let go of the object, and see that no finger touches it any more.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when nothing is held; CONTROL_FAILED, when it still sticks.
    """
    hand = cell.gripper
    name = step.object or (cell.held[-1] if cell.held else None)
    if name is None:
        raise StepFailed("INVALID_OBJECT_NAME", "nothing was grasped, so nothing can be released")
    target = hand.open_position
    if step.named_target is not None:
        target = cell.description.states_of(hand.group)[step.named_target].positions[hand.joint]
    elif step.position is not None:
        target = step.position
    cell.simulator.unweld(name)
    result = cell.simulator.command_gripper(
        target, hand.max_effort, timeout=step.timeout or DEFAULT_TIMEOUT
    )
    note_result(cell, target, result)
    touching = [side for side, names in result.contacts.items() if name in names]
    if touching:
        sides = " and ".join(f"the {side} finger" for side in touching)
        raise StepFailed("CONTROL_FAILED", f"{sides} still touches '{name}' with the gripper open")
    cell.detach(name)
    cell.notes.result["released"] = name
