"""Steps that no ROS 2 robot can carry out: refused at their lines, before anything moves."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from harness.cell.program import Program, ProgramStep
from harness.cell.step import Step
from harness.cell.watched_goals import places_in
from harness.core.errors import SpecError
from harness.core.geometry import reach
from harness.core.world import WorldObject
from harness.session.prepare import Prepared
from harness.steps.grasp import Grasp
from harness.steps.gripper import Gripper
from harness.steps.pick import Pick
from harness.steps.place import Place

Reason = tuple[str, str]  # why it is impossible, and what the user does instead

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
    for step in program.all_steps():
        reason = step.spec.simulated_only or _reason(step, program)
        if reason is not None:
            yield step, reason


def _reason(step: ProgramStep, program: Program) -> Reason | None:
    """Why what a step says is impossible; None where nothing is."""
    spec = step.spec
    physical = {obj.name: obj for obj in program.all_objects() if obj.in_simulation}
    if spec.moves_objects and _changed(spec, program) & {*physical}:
        return _CELL
    in_motion = isinstance(spec, Pick | Place) and spec.track
    frames = {place.frame for place in places_in(spec)} if spec.moves_arm else set[str]()
    if in_motion or frames & _carried(physical.values()):
        return _BELT
    if isinstance(spec, Pick | Grasp) and spec.mode == "weld":
        return _WELD
    if spec.is_at_once and any(isinstance(c.spec, Gripper) for c in step.children):
        return _AT_ONCE
    return None


def _changed(spec: Step, program: Program) -> set[str]:
    """Names of the objects that a step adds, removes or puts elsewhere."""
    content = dict(spec)
    if "object" in content:
        return {content["object"]}
    if "objects" in content:
        return {getattr(each, "name", each) for each in content["objects"]}
    cleared = program.all_objects() if content.get("world") else program.later_objects.values()
    return {obj.name for obj in cleared}


def _carried(objects: Collection[WorldObject]) -> set[str]:
    """Names of the objects that stand over a belt that runs from the start."""
    belts = [obj for obj in objects if obj.surface_motion and not obj.surface_motion.is_still]
    return {
        obj.name
        for obj in objects
        for belt in belts
        for shape in belt.shapes
        if not obj.is_static
        and (half := reach(shape.geometry, np.eye(3))) is not None
        and (abs((belt.pose @ shape.pose).inverse().apply(obj.pose.translation)) < half)[:2].all()
    }
