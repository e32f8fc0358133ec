"""What to do about a failed step, in the keys of the step."""

from __future__ import annotations

from collections.abc import Iterator

from harness.cell.cell import Cell
from harness.cell.grasping import can_hold, has_simple_shape, least_gap
from harness.core.errors import StepFailed
from harness.core.registry import OWN_PACKAGE, registry
from harness.plugins.diagnosis.approach_advice import approach_advice
from harness.recording.execution_failures import (
    ControlFailure,
    GraspFailure,
    UnrestFailure,
    WidthFailure,
)
from harness.recording.explanation import ApproachFailure, Explanation
from harness.steps.pick import Pick


def advice(failure: StepFailed, cell: Cell) -> str:
    """One sentence for the step's record; empty where the message says it all."""
    control = failure.details.find(ControlFailure)
    is_grasp = failure.details.find(GraspFailure) is not None
    if (control is not None or is_grasp) and cell.faults:
        injected = ", ".join(f"{name} (line {line})" for name, line in cell.faults.items())
        return f"look first at the faults that were injected: {injected}"
    if failure.details.find(ApproachFailure) is not None:
        return approach_advice(failure, cell)
    if failure.details.find(Explanation) is not None:
        return ""
    if (width := failure.details.find(WidthFailure)) is not None:
        return _about_width(width, cell)
    if is_grasp:
        start = (
            "bring the TCP to the object first (a `move_to` above it, then `lin`), or give `pick`"
            " another `grasp_pose`; "
        )
        if cell.gripper.cups:
            return start + "every cup needs a face under the whole of its rim"
        gap = f"{1e3 * least_gap(cell):.1f} mm"
        return f"{start}the pads of the closed gripper are {gap} apart, and hold nothing thinner"
    if control is not None:
        return _about_contacts(control, cell)
    if failure.details.find(UnrestFailure) is not None:
        return (
            "give the step a longer `timeout`, or allow more motion with `max_velocity`; what rolls"
            " or slides for ever needs something to stop it"
        )
    return ""


def _about_width(failure: WidthFailure, cell: Cell) -> str:
    if can_hold(failure.height, cell):
        height = f"{failure.height * 1e3:.1f} mm"
        return f"its height of {height} fits: give a `grasp_pose` that takes it from the side"
    step = cell.current.spec
    if isinstance(step, Pick) and not has_simple_shape(cell.presence[step.object].obj):
        return "give a `grasp_pose` that takes it by a part that fits"
    other = "a narrower object, or a gripper that opens wider"
    if failure.width < failure.least_gap:
        other = "a thicker object, or a gripper that closes further"
    return f"take {other}: no side of it fits"


def _about_contacts(failure: ControlFailure, cell: Cell) -> str:
    touched = list(_touched_objects(failure, cell))
    unknown = [name for name in touched if not cell.presence[name].obj.in_planning]
    if unknown:
        return (
            f"the planner does not know {unknown[0]} (it is `in: simulation`): let it be in both,"
            " or expect the contact"
        )
    if touched:
        return f"look where {touched[0]} stood when this was planned: it moved, or was moved"
    name = cell.description.joint_controller
    if registry("controller").package_of(name) != OWN_PACKAGE:
        return f"correct the plug-in `{name}`, or leave out `joint_controller`"
    return "lower the scaling factors in `planning`, or look at the joint's effort limit"


def _touched_objects(failure: ControlFailure, cell: Cell) -> Iterator[str]:
    for contact in failure.contacts:
        yield from (name for name in contact.bodies if name in cell.presence)
