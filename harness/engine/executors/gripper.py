"""gripper: GripperCommand."""

from __future__ import annotations

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.engine.registry import execute
from harness.ports import GripperResult
from harness.robot.description import Gripper as GripperDescription
from harness.spec.steps import Gripper

DEFAULT_TIMEOUT = 10.0  # [s] of simulation


@execute.handles(Gripper)
def gripper(step: Gripper, cell: Cell) -> None:
    """Drive the gripper's joint until it arrives or stalls; a stall is no failure, as in ROS.

    Raises:
        StepFailed: TIMED_OUT, when it does neither in time.
    """
    hand = cell.gripper
    target, effort = command_of(step, cell)
    timeout = step.timeout or DEFAULT_TIMEOUT
    result = cell.simulator.command_gripper(target, effort, timeout=timeout)
    note_result(cell, target, result)
    if not (result.reached_goal or result.stalled):
        raise StepFailed(
            "TIMED_OUT",
            f"'{hand.joint}' is at {result.position:.4g} and still moves towards {target:.4g}"
            f" after {timeout:g} s",
        )


def command_of(step: Gripper, cell: Cell) -> tuple[float, float]:
    """GripperCommand's position and max_effort that a step asks for."""
    hand = cell.gripper
    effort = step.max_effort or hand.grip_effort
    if step.named_target is not None:
        states = cell.description.states_of(hand.group)
        return states[step.named_target].positions[hand.joint], effort
    if step.position is not None:
        return step.position, effort
    return position_for_width(hand, step.width or 0.0), effort


def position_for_width(hand: GripperDescription, width: float) -> float:
    """Joint position at which the pads are `width` apart [m]."""
    rows = hand.widths[np.argsort(hand.widths[:, 1])]
    return float(np.interp(width, rows[:, 1], rows[:, 0]))


def note_result(cell: Cell, target: float, result: GripperResult) -> None:
    """Leave GripperCommand's result, and the contacts, in the step's record."""
    cell.notes.result.update(
        target=target,
        position=result.position,
        effort=result.effort,
        stalled=result.stalled,
        reached_goal=result.reached_goal,
        contacts={side: list(names) for side, names in result.contacts.items()},
    )
