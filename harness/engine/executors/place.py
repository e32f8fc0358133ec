"""place: approach, lower, release, retreat, as Task Constructor's Place; each is recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.errors import PlanningFailed, StepFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.engine.cell import Cell
from harness.engine.executors.pick import (
    arm_has_six_joints,
    relative_step,
    travel_distance,
    world_pose_spec,
)
from harness.engine.goals import TcpGoal, group_of
from harness.engine.grasping import UP, gripper_axes, pitch_of
from harness.engine.program import ProgramStep
from harness.engine.registry import execute
from harness.ports import PositionGoal
from harness.spec.poses import Direction, Position
from harness.spec.steps import Place, Release, Travel

REFINEMENTS = 4
PUT_DOWN_GAP = 0.001  # [m] above the target, so that the support is touched when the fingers open
DEFAULT_RETREAT = Travel(min_distance=0.03, max_distance=0.1)


@execute.handles(Place)
def place(step: Place, cell: Cell) -> None:
    """Go above the target, lower straight, release, retreat against the gripper's approach axis."""
    name = step.object or (cell.held[-1] if cell.held else None)
    if name is None or name not in cell.scene.attached():
        what = f"'{name}' is not held" if name else "nothing is held"
        raise StepFailed("INVALID_OBJECT_NAME", f"{what}, so nothing can be placed")
    stated = cell.world_pose(step.pose)
    target = SE3(stated.rotation, stated.translation + PUT_DOWN_GAP * UP)
    along = -UP
    if step.approach is not None and step.approach.direction is not None:
        along = cell.world_direction(step.approach.direction)
    before = SE3(target.rotation, target.translation - travel_distance(step.approach) * along)
    backwards = _retreat_direction(cell)
    children = [
        cell.child(
            "reach",
            _tcp_goal(name, before, step, cell).move_to(step.group),
            f"move_to above the place of {name}",
        ),
        _touching(
            cell.child("lower", _tcp_goal(name, target, step, cell).lin(step.group), f"lin {name}")
        ),
        cell.child("release", Release(object=name), f"release {name}"),
        cell.child(
            "retreat",
            relative_step(step.retreat or DEFAULT_RETREAT, backwards, step.group),
            "move_relative back",
        ),
    ]
    cell.run_children(children)


def _touching(step: ProgramStep) -> ProgramStep:
    """The step without padding: what is put down comes as near to its support as it will stand."""
    return replace(step, options=replace(step.options, padding=0.0))


def _retreat_direction(cell: Cell) -> Direction:
    """Against the gripper's approach axis, in the TCP's frame, so it is read when it is needed."""
    x, y, z = (-float(value) for value in gripper_axes(cell)[0])
    return Direction(xyz=(x, y, z), frame=cell.description.tcp_link)


def _tcp_goal(name: str, target: SE3, step: Place, cell: Cell) -> TcpGoal:
    """Where the TCP must be so that the held object, as the planner believes it, is at a pose."""
    start = cell.planning_start()
    tcp = cell.kinematics.link_pose(start, cell.description.tcp_link)
    tcp_to_object = tcp.inverse() @ cell.scene.object_pose(name, start)
    if arm_has_six_joints(cell, step.group):
        return TcpGoal(world_pose_spec(target @ tcp_to_object.inverse()))
    pitch = pitch_of(tcp.rotation)
    x, y, z = _tcp_position(target.translation, tcp_to_object, pitch, step, cell)
    return TcpGoal(Position(xyz=(float(x), float(y), float(z))), pitch)


def _tcp_position(
    point: FloatArray, tcp_to_object: SE3, pitch: float, step: Place, cell: Cell
) -> FloatArray:
    """TCP position at which the object's origin is at a point, for arms that choose their own yaw.

    The yaw follows from the position, so the offset is corrected a few times from where the
    solution puts the object.
    """
    group, start = group_of(cell, step.group), cell.planning_start()
    link, position = cell.description.tcp_link, np.array(point)
    for _ in range(REFINEMENTS):
        goal = PositionGoal(link, position, pitch)
        solutions = cell.kinematics.solve(group, goal, start, cell.current.options.seed)
        if not solutions:
            raise PlanningFailed(
                "NO_IK_SOLUTION",
                f"no joint positions put the held object at ({point[0]:.3f}, {point[1]:.3f},"
                f" {point[2]:.3f}) with the gripper pitched {np.degrees(pitch):.1f} degrees",
            )
        state = np.array(start)
        state[list(cell.description.group_indices(group))] = solutions[0]
        tcp = cell.kinematics.link_pose(cell.description.with_mimics(state), link)
        position = position + point - (tcp @ tcp_to_object).translation
    return position
