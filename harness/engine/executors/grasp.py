"""grasp: close until both finger sides touch the object, then attach it in the planning scene."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.engine.executors.gripper import DEFAULT_TIMEOUT, note_result
from harness.engine.registry import execute
from harness.spec.steps import Grasp


@execute.handles(Grasp)
def grasp(step: Grasp, cell: Cell) -> None:
    """Close, verify the contact on both sides, attach; with mode `weld` fix it in the physics too.

    Raises:
        StepFailed: CONTROL_FAILED, when a finger side does not touch the object.
    """
    hand = cell.gripper
    target = hand.closed_position if step.position is None else step.position
    result = cell.simulator.command_gripper(
        target, step.max_effort or hand.grip_effort, timeout=step.timeout or DEFAULT_TIMEOUT
    )
    note_result(cell, target, result)
    cell.notes.result["mode"] = step.mode
    empty = [side for side, names in result.contacts.items() if step.object not in names]
    if empty:
        raise StepFailed("CONTROL_FAILED", _missed(step.object, empty, cell), cell.notes.result)
    cell.sync_scene()
    cell.attach(step.object, cell.description.tcp_link, hand.links)
    if step.mode == "weld":
        cell.simulator.weld(step.object, hand.palm_link)
    cell.held.append(step.object)


def _missed(name: str, empty: list[str], cell: Cell) -> str:
    """Which side misses, and how the object stands to the TCP."""
    tcp = cell.frame(cell.description.tcp_link)
    offset = tcp.inverse().apply(cell.frame(name).translation) * 1e3
    sides = " and ".join(f"the {side} finger" for side in empty)
    return (
        f"{sides} did not touch '{name}' when the gripper closed; its origin stands"
        f" ({offset[0]:.1f}, {offset[1]:.1f}, {offset[2]:.1f}) mm from the TCP, in the TCP's axes"
    )
