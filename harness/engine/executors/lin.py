"""lin: Pilz's straight line."""

from __future__ import annotations

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.engine.cell import Cell
from harness.engine.executors.pick import arm_has_six_joints
from harness.engine.goals import group_of, resolve_goal
from harness.engine.grasping import pitch_of, pitched
from harness.engine.registry import execute
from harness.ports import JointGoal, PoseGoal, PositionGoal
from harness.spec.steps import Lin


@execute.handles(Lin)
def lin(step: Lin, cell: Cell) -> None:
    """Move the link on a straight line to the goal, turning at an even rate."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    start = cell.planning_start()
    goal = resolve_goal(step, group, cell)
    if isinstance(goal, JointGoal):
        goal = _pose_of(goal, group, start, cell)
    elif isinstance(goal, PositionGoal):
        goal = _towards(goal, group, start, cell)
    cell.carry_out(cell.planner.plan_linear(group, start, goal, cell.current.options))


def _pose_of(goal: JointGoal, group: str, start: FloatArray, cell: Cell) -> PoseGoal:
    """Where the TCP stands at joint positions: a line ends there, as Pilz's LIN does."""
    link = cell.description.tcp_link
    return PoseGoal(
        link, cell.kinematics.link_pose(_state(goal.positions, group, start, cell), link)
    )


def _towards(goal: PositionGoal, group: str, start: FloatArray, cell: Cell) -> PoseGoal:
    """Where a line to a point ends: the link turned as it is, but for a pitch that is asked for.

    An arm of fewer than six joints cannot keep its link turned so: its yaw follows from the point.
    """
    now = cell.kinematics.link_pose(start, goal.link)
    turned = now.rotation if goal.pitch is None else pitched(now.rotation, goal.pitch)
    if not arm_has_six_joints(cell, group):
        pitch = pitch_of(now.rotation) if goal.pitch is None else goal.pitch
        wanted = PositionGoal(goal.link, goal.position, pitch)
        solutions = cell.kinematics.solve(group, wanted, start, cell.current.options.seed)
        if solutions:
            end = _state(solutions[0], group, start, cell)
            turned = cell.kinematics.link_pose(end, goal.link).rotation
    return PoseGoal(goal.link, SE3(turned, goal.position), goal.position_tolerance)


def _state(positions: FloatArray, group: str, start: FloatArray, cell: Cell) -> FloatArray:
    """All joints, with the group's at given positions."""
    state = np.array(start)
    state[list(cell.description.group_indices(group))] = positions
    return cell.description.with_mimics(state)
