"""Steps that no ROS 2 robot can carry out: refused at their lines, before anything moves."""

from __future__ import annotations

from collections.abc import Iterator

from harness.cell.program import Program, ProgramStep
from harness.cell.step import Step
from harness.core.errors import SpecError
from harness.session.prepare import Prepared
from harness.steps.grasp import Grasp
from harness.steps.gripper import Gripper
from harness.steps.move_object import MoveObject
from harness.steps.pick import Pick
from harness.steps.place import Place

Reason = tuple[str, str]  # why it is impossible, and what the user does instead

_CONTACT: Reason = (
    "a trajectory controller is not stopped or moved within milliseconds of a contact",
    "use a `lin` that ends where the contact is, or the force mode of the robot's driver in a"
    " program of its own, and judge the recording with `harness grade`",
)
_CELL: Reason = (
    "a program cannot put objects into the real cell or take them out",
    "write `in: planning` for what only the planner has to know, or leave the step out",
)
_BELT: Reason = (
    "the arm cannot meet a moving object there: its motions end at rest",
    "stop the belt, and leave `track` out",
)
_WELD: Reason = ("an object cannot be welded to a real gripper", "leave out `mode: weld`")
_AT_ONCE: Reason = (
    "arm and gripper do not move at once there",
    "write the `gripper` step before or after the motion",
)
_BY_VERB: dict[str, Reason] = {
    **dict.fromkeys(("move_until", "comply", "search"), _CONTACT),
    "conveyor": (
        "a belt of the real cell is not driven by a scenario",
        "leave the step out, and let the cell's own controller drive the belt",
    ),
    "inject": ("faults are injected into simulated robots alone", "leave the step out"),
}


def refuse_steps(prepared: Prepared) -> None:
    """Refuse a scenario with steps that a ROS 2 robot cannot carry out.

    Raises:
        SpecError: There are some; with all of them.
    """
    program, lines = prepared.program, prepared.loaded.lines
    problems = [
        lines.problem(
            program.step_locs.get(step.path, ("steps",)),
            f"`{step.spec.verb}` is not possible on a ROS 2 robot: {why}",
            f"{instead}; without `--robot ros2` the step is simulated",
        )
        for step, (why, instead) in _refused(program)
    ]
    if problems:
        raise SpecError(problems)


def _refused(program: Program) -> Iterator[tuple[ProgramStep, Reason]]:
    physical = {obj.name for obj in program.all_objects() if obj.in_simulation}
    for step in program.all_steps():
        reason = _BY_VERB.get(step.spec.verb) or _reason(step, physical)
        if reason is not None:
            yield step, reason


def _reason(step: ProgramStep, physical: set[str]) -> Reason | None:
    """Why what a step says is impossible; None where nothing is.

    Args:
        physical: The names of the objects that are not of the planning scene alone.
    """
    spec = step.spec
    if _changed(spec) & physical:
        return _CELL
    if isinstance(spec, Pick | Place) and spec.track:
        return _BELT
    if isinstance(spec, Pick | Grasp) and spec.mode == "weld":
        return _WELD
    if spec.verb == "parallel" and any(isinstance(c.spec, Gripper) for c in step.children):
        return _AT_ONCE
    return None


def _changed(spec: Step) -> set[str]:
    """Names of the objects that a step adds, removes or puts elsewhere."""
    if isinstance(spec, MoveObject):
        return {spec.object}
    if spec.verb in ("add_object", "remove_object"):
        return {getattr(each, "name", each) for each in dict(spec)["objects"]}
    return set()
