"""What the constraints of a request require, as goals and path constraints of the planner."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NoReturn

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import ErrorCode, StepFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.base import LARGEST_NUMBER
from harness.plugins.ros.moveit.values import SMALLEST_NORM, frame_of, link_of, pose_of
from harness.ports.goals import (
    AnyGoal,
    Goal,
    JointBand,
    JointGoal,
    OrientationBand,
    PathConstraints,
    PoseGoal,
    PositionBox,
    PositionGoal,
)
from harness.ports.motions import ArcPoint

BOX, SPHERE = 1, 2
"""Types of shape_msgs/SolidPrimitive."""

HALF_TURN = 3.14
"""The least tolerance that allows any turn [rad]: clients write pi with few digits."""

PLACES = 8
"""Places that are tried for a goal of an orientation alone, besides the one where the link is: most
of them are in reach, and one is enough."""

TIGHTEST = 1e-4
"""The least tolerance of a goal [m or rad]: what inverse kinematics reaches."""


def goal_of(cell: Cell, group: str, constraints: Any, start: FloatArray) -> Goal | AnyGoal:
    """The goal of a request: one of its `goal_constraints`; joints without one stay at the start.

    Raises:
        StepFailed: There is none, or one of them is no goal that can be planned.
    """
    goals = tuple(goal for each in constraints for goal in _goals(cell, group, each, start))
    if not goals:
        _refuse("INVALID_GOAL_CONSTRAINTS", "the request has no goal_constraints")
    return goals[0] if len(goals) == 1 else AnyGoal(goals)


def _goals(cell: Cell, group: str, constraints: Any, start: FloatArray) -> Iterator[Goal]:
    """A goal, or several that are alternatives."""
    joints, places = constraints.joint_constraints, constraints.position_constraints
    turns = constraints.orientation_constraints
    if constraints.visibility_constraints:
        _refuse("UNRECOGNIZED_GOAL_TYPE", "goals of visibility are not planned")
    if joints:
        if places or turns:
            _refuse("UNRECOGNIZED_GOAL_TYPE", "a goal has joints, or a pose, and not both")
        yield _joint_goal(cell, group, joints, start)
        return
    if not 1 <= len(places) + len(turns) <= 2 or max(len(places), len(turns)) > 1:
        _refuse(
            "UNRECOGNIZED_GOAL_TYPE",
            f"a goal has {len(places)} position and {len(turns)} orientation constraints; one of"
            " each is possible",
        )
    if places:
        yield _place_goal(cell, group, places[0], turns)
    else:
        yield from _turned_goals(cell, group, turns[0], start)


def _place_goal(cell: Cell, group: str, place: Any, turns: Any) -> Goal:
    link = link_of(cell, place.link_name, group)
    middle, size = _region(cell, place)
    reach = max(TIGHTEST, min(size) / 2)
    offset = np.array([getattr(place.target_point_offset, axis) for axis in "xyz"], dtype=float)
    if not turns:
        if offset.any():
            _refuse("UNRECOGNIZED_GOAL_TYPE", "an offset of the target point needs an orientation")
        return PositionGoal(link, middle.translation, position_tolerance=reach)
    turn = turns[0]
    if link_of(cell, turn.link_name, group) != link:
        _refuse("UNRECOGNIZED_GOAL_TYPE", "position and orientation are of two links")
    rotation = _rotation(cell, turn)
    tolerance = _tolerances(turn)
    return PoseGoal(
        link,
        SE3(rotation, middle.translation - rotation @ offset),
        position_tolerance=reach,
        orientation_tolerance=max(TIGHTEST, *tolerance),
        axis_tolerances=tolerance,
    )


def _turned_goals(cell: Cell, group: str, turn: Any, start: FloatArray) -> Iterator[Goal]:
    """A link is turned, wherever it is: where it is now, and elsewhere as alternatives."""
    link, rotation, tolerance = (
        link_of(cell, turn.link_name, group), _rotation(cell, turn), _tolerances(turn)
    )  # fmt: skip
    names, robot, seed = (
        cell.description.groups[group].joint_names, cell.description, cell.current.options.seed
    )  # fmt: skip
    columns = [robot.joint_index[name] for name in names]
    joints = [robot.joint_by_name[name] for name in names]
    lower, upper = (
        np.nan_to_num([getattr(joint, side) for joint in joints], posinf=np.pi, neginf=-np.pi)
        for side in ("lower", "upper")
    )
    states = [start]
    for drawn in np.random.default_rng(seed).uniform(lower, upper, (PLACES, len(names))):
        states.append(start.copy())
        states[-1][columns] = drawn
    for state in states:
        at = cell.kinematics.link_pose(robot.with_mimics(state), link).translation
        yield PoseGoal(
            link,
            SE3(rotation, at),
            position_tolerance=TIGHTEST,
            orientation_tolerance=max(tolerance),
            axis_tolerances=tolerance,
        )


def _joint_goal(cell: Cell, group: str, constraints: Any, start: FloatArray) -> JointGoal:
    """A joint that follows another one, as a finger may, must be where it follows to."""
    robot, names = cell.description, cell.description.groups[group].joint_names
    goal, index = start.copy(), robot.joint_index
    masters = {joint.name: joint.mimic.joint for joint in robot.movable_joints if joint.mimic}
    for each in constraints:
        name = str(each.joint_name)
        if masters.get(name, name) not in names:
            reason = f"'{name[:80]}' is no joint of '{group}', which has {', '.join(names)}"
            _refuse("INVALID_GOAL_CONSTRAINTS", reason)
        if not np.isfinite(each.position):
            _refuse("INVALID_GOAL_CONSTRAINTS", f"the position of '{name}' is not finite")
        goal[index[name]] = each.position
    goal = robot.with_mimics(goal)
    for each in constraints:
        name = str(each.joint_name)
        off = goal[index[name]] - each.position
        if not -max(TIGHTEST, each.tolerance_below) <= off <= max(TIGHTEST, each.tolerance_above):
            why = f"follows '{masters[name]}'" if name in masters else "has another constraint"
            reason = f"'{name}' {why}: {goal[index[name]]:.5g}, not {each.position:.5g}"
            _refuse("INVALID_GOAL_CONSTRAINTS", reason)
    return JointGoal(goal[[index[name] for name in names]])


def path_constraints_of(cell: Cell, constraints: Any) -> PathConstraints | None:
    """What must hold all along the motion; None for nothing.

    Raises:
        StepFailed: A constraint is of a kind that the planner does not keep.
    """
    turns, places = constraints.orientation_constraints, constraints.position_constraints
    joints = constraints.joint_constraints
    if constraints.visibility_constraints or len(turns) > 1 or len(places) > 1:
        _refuse(
            "FAILURE",
            "path constraints may have one orientation, one position, and joints",
        )
    if not (turns or places or joints):
        return None
    orientation = position = None
    for turn in turns:
        body = _body(cell, turn.link_name)
        orientation = OrientationBand(body, _rotation(cell, turn), _tolerances(turn))
    for place in places:
        middle, size = _region(cell, place)
        offset = place.target_point_offset
        if offset.x or offset.y or offset.z:
            _refuse("FAILURE", "path constraints of a position take no offset of the target point")
        if place.constraint_region.primitives[0].type == SPHERE:
            side = size[0] / math.sqrt(3)  # of the cube inside
            size = (side, side, side)
        position = PositionBox(_body(cell, place.link_name), middle, size)
    bands = tuple(
        JointBand(str(j.joint_name), j.position - j.tolerance_below, j.position + j.tolerance_above)
        for j in joints
    )
    if unknown := [band.joint for band in bands if band.joint not in cell.description.joint_index]:
        _refuse("INVALID_GOAL_CONSTRAINTS", f"the robot has no joint '{unknown[0][:80]}'")
    return PathConstraints(orientation, position, bands)


def arc_point_of(cell: Cell, constraints: Any) -> ArcPoint:
    """Pilz's way to name an arc: path constraints called `interim` or `center`, with a position.

    Raises:
        StepFailed: They are called otherwise, or have no position.
    """
    name, places = str(constraints.name), constraints.position_constraints
    if (
        name not in ("interim", "center")
        or len(places) != 1
        or not places[0].constraint_region.primitive_poses
    ):
        _refuse(
            "INVALID_MOTION_PLAN",
            "CIRC needs path_constraints called `interim` or `center`, with one position",
        )
    pose = pose_of(places[0].constraint_region.primitive_poses[0])
    point = frame_of(cell, str(places[0].header.frame_id)).apply(pose.translation)
    return ArcPoint("interim" if name == "interim" else "center", point)


def _region(cell: Cell, constraint: Any) -> tuple[SE3, tuple[float, float, float]]:
    """The middle of a region in the world, and its size; a sphere's is its diameter."""
    region = constraint.constraint_region
    if len(region.primitives) != 1 or len(region.primitive_poses) != 1 or region.meshes:
        _refuse("INVALID_GOAL_CONSTRAINTS", "a position is constrained to one box or sphere")
    primitive = region.primitives[0]
    sizes = [float(each) for each in primitive.dimensions]
    if primitive.type == SPHERE and len(sizes) == 1:
        sizes = [2 * sizes[0]] * 3
    elif primitive.type != BOX or len(sizes) != 3:
        _refuse("INVALID_GOAL_CONSTRAINTS", "a position is constrained to one box or sphere")
    if not np.isfinite(sizes).all() or min(sizes) < 0:
        _refuse("INVALID_GOAL_CONSTRAINTS", "the size of a region is no length")
    frame = frame_of(cell, str(constraint.header.frame_id))
    x, y, z = sizes
    return frame @ pose_of(region.primitive_poses[0]), (x, y, z)


def _rotation(cell: Cell, constraint: Any) -> FloatArray:
    """R_world_link of an orientation constraint."""
    frame = frame_of(cell, str(constraint.header.frame_id))
    turn = constraint.orientation
    values = np.array([turn.w, turn.x, turn.y, turn.z], dtype=float)
    if not SMALLEST_NORM <= math.hypot(*values) <= LARGEST_NUMBER:
        _refuse("INVALID_GOAL_CONSTRAINTS", "an orientation is no quaternion")
    return (frame @ SE3.from_xyz_quat((0, 0, 0), values)).rotation


def _tolerances(constraint: Any) -> tuple[float, float, float]:
    """The tolerances about the link's x, y, z [rad]; what clients write for pi is pi."""
    axes = (float(getattr(constraint, f"absolute_{axis}_axis_tolerance")) for axis in "xyz")
    x, y, z = (max(TIGHTEST, each) if each < HALF_TURN else np.pi for each in axes)
    return x, y, z


def _body(cell: Cell, name: str) -> str:
    """A link or an attached object."""
    return str(name) if str(name) in cell.scene.attached() else link_of(cell, name)


def _refuse(code: ErrorCode, reason: str) -> NoReturn:
    raise StepFailed(code, reason)
