"""What to do where an object can be picked or placed nowhere that a step allows."""

from __future__ import annotations

import numpy as np

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.cell.grasping import UP
from harness.core.amounts import point_text
from harness.core.errors import StepFailed
from harness.core.types import FloatArray
from harness.recording.explanation import ApproachFailure, Explanation, NearestState
from harness.steps._approach import millimetres
from harness.steps.pick import GraspChoice, Pick
from harness.steps.place import PUT_DOWN_GAP, Place, placings


def approach_advice(failure: StepFailed, cell: Cell) -> str:
    """What to do where no approach is possible; empty where nothing is known."""
    match cell.current.spec:
        case Pick() as step:
            return pick_advice(step, failure, cell)
        case Place() as step:
            return place_advice(step, failure, cell)
        case _:
            return ""


def pick_advice(step: Pick, failure: StepFailed, cell: Cell) -> str:
    """What to do in the keys of a pick."""
    choice = cell.notes.result.find(GraspChoice)
    grasps = 1 if choice is None else choice.grasps
    if held := cell.held_objects:
        return f"the gripper still holds '{held[-1]}': `place` or `release` it before this"
    if failure.code.startswith("START_STATE"):
        return ""  # the planner's advice is about the start
    if failure.code == "GOAL_IN_COLLISION":
        return _collision_advice(step, failure, grasps, cell)
    if advice := start_advice(failure, "the grasp"):
        return advice
    if failure.code == "GOAL_CONSTRAINTS_VIOLATED":
        joints = len(cell.description.groups[group_of(cell, step.group)].joint_names)
        return (
            f"an arm of {joints} joints cannot reach every rotation at a point: leave the rotation"
            " out of `grasp_pose` and the arm finds its own; `pitch` states how far the gripper"
            " points down"
        )
    nearest = nearest_state(failure)
    moved, away = "", (nearest.position_error if nearest else None) or 0.0
    if nearest is not None and nearest.pose is not None and away >= 1e-3:
        there = point_text(np.round(nearest.pose[:3], 3))
        moved = (
            f"the nearest point that the gripper reaches is {there}, {millimetres(away)}"
            f" from the grasp: bring '{step.object}' or the robot's `base` nearer by that much"
        )
    if step.grasp_pose is not None and step.grasp_pose.has_rotation:
        freer = "leave the rotation out of `grasp_pose`, so that every grasp from above is tried"
    elif step.pitch is not None:
        freer = "leave out `pitch`, so that every pitch is tried"
    else:
        tried = f"{grasps} grasps were tried" if grasps > 1 else "one grasp was tried"
        freer = f"{tried}; state another one with `grasp_pose`"
    return "; or ".join(part for part in (moved, freer) if part)


def _collision_advice(step: Pick, failure: StepFailed, grasps: int, cell: Cell) -> str:
    nearest = nearest_state(failure)
    if nearest is None or not nearest.touches or nearest.touches[0].distance >= 0:
        return ""  # the padding is in the way, and the planner's advice says so
    deepest = nearest.touches[0]
    pair, depth = deepest.pair, millimetres(-deepest.distance)
    blockers = [name for name in pair if name in cell.presence and name != step.object]
    can_move = bool(blockers) and not cell.presence[blockers[0]].obj.is_static
    tried = f"none of {grasps} grasps is free" if grasps > 1 else "the grasp is not free"
    if step.object in pair and not blockers and _moves_with_object(step):
        link = next(name for name in pair if name != step.object)
        return (
            f"{tried}: it moves with '{step.object}', so moving that does not help; state another"
            f" one with `grasp_pose`, which keeps '{link}' {depth} farther out, or give"
            f" '{step.object}' a shape that fits between the fingers"
        )
    moved = f"move '{step.object}' to where the gripper has {depth} more room"
    if blockers:
        moved = f"move '{step.object}' {depth} farther from '{blockers[0]}'"
    if nearest.nearest_free is not None:
        shift = nearest.nearest_free.shift
        axis = max(range(3), key=lambda index: abs(shift[index]))
        sign = "+" if shift[axis] > 0 else "-"
        far, along = millimetres(abs(shift[axis])), f"{sign}{'xyz'[axis]}"
        moved = f"move '{step.object}' {far} along {along} of the world"
    if can_move:
        moved += f", or '{blockers[0]}' out of the way"
    return f"{tried}: {moved}; or state another grasp with `grasp_pose`"


def _moves_with_object(step: Pick) -> bool:
    """Whether the grasp stays where it is on the object when that is moved."""
    return step.grasp_pose is None or step.grasp_pose.frame == step.object


def place_advice(step: Place, failure: StepFailed, cell: Cell) -> str:
    """What to do in the keys of a place."""
    if failure.code.startswith("START_STATE"):
        return ""  # the planner's advice is about the start
    if advice := start_advice(failure, "the place"):
        return advice
    name = step.object_placed(cell)
    stated = placings(name, step, cell)[0].translation - PUT_DOWN_GAP * UP
    nearest = nearest_state(failure)
    if failure.code == "GOAL_IN_COLLISION":
        if nearest is None or nearest.nearest_free is None:
            return ""
        shift = np.array(nearest.nearest_free.shift)
        return (
            f"move '{name}' to where it is free: `pose: {{{_xyz(stated + shift)}}}`, or"
            " move what is in the way"
        )
    if nearest is None:
        return ""
    state = np.array([nearest.joint_positions[joint] for joint in cell.description.joint_names])
    pose = cell.scene.object_pose(name, state)
    point = pose.translation - PUT_DOWN_GAP * UP
    away = float(np.linalg.norm(point - stated))
    return (
        f"the nearest place that the arm can bring '{name}' to, held as it is, is `pose:"
        f" {{{_xyz(point)}}}`, {millimetres(away)} away; or pick it with another `pitch` or"
        " `grasp_pose`"
    )


def _xyz(point: FloatArray) -> str:
    x, y, z = np.round(point, 3) + 0.0
    return f"xyz: [{x:g}, {y:g}, {z:g}]"


def start_advice(failure: StepFailed, end: str) -> str:
    """What to do where the end of an approach can be reached and its start cannot, else nothing.

    Args:
        end: The end in words: `the grasp`.
    """
    approach = failure.details.find(ApproachFailure)
    if approach is None or not approach.is_start_of_approach:
        return ""
    return (
        f"{end} can be reached, the start of its approach cannot: give `approach` a shorter"
        " `distance`, or another `direction`"
    )


def nearest_state(failure: StepFailed) -> NearestState | None:
    """The state that the planner explains a failure by."""
    explained = (part.nearest for part in failure.details if isinstance(part, Explanation))
    return next((nearest for nearest in explained if nearest is not None), None)
