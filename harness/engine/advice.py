"""What to do about a failure that the planner has not explained."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from harness.cell.cell import Cell
from harness.cell.grasping import least_gap
from harness.core.errors import StepFailed


def advice(failure: StepFailed, cell: Cell) -> str:
    """One sentence for the step's record; empty where the message says it all."""
    if failure.code == "CONTROL_FAILED" and "contacts" in failure.facts:
        return _about_contacts(failure.facts, cell)
    if failure.code == "TIMED_OUT" and "moving" in failure.facts:
        return (
            "give the step a longer `timeout`, or allow more motion with `max_velocity`; what rolls"
            " or slides for ever needs something to stop it"
        )
    return ""


def _about_contacts(facts: Mapping[str, Any], cell: Cell) -> str:
    if "joint" not in facts:  # a grasp: `contacts` are those of the finger sides
        return (
            "bring the TCP to the object first (a `move_to` above it, then `lin`), or give `pick`"
            f" another `grasp_pose`; the pads of the closed gripper are {1e3 * least_gap(cell):.1f}"
            " mm apart, and hold nothing thinner"
        )
    touched = list(_touched_objects(facts, cell))
    unknown = [name for name in touched if not cell.presence[name].obj.in_planning]
    if unknown:
        return (
            f"the planner does not know {unknown[0]} (it is `in: simulation`): let it be in both,"
            " or expect the contact"
        )
    if touched:
        return f"look where {touched[0]} stood when this was planned: it moved, or was moved"
    return "lower the scaling factors in `planning`, or look at the joint's effort limit"


def _touched_objects(facts: Mapping[str, Any], cell: Cell) -> Iterator[str]:
    for contact in facts["contacts"]:
        yield from (name for name in contact["bodies"] if name in cell.presence)
