"""lin: Pilz's straight line."""

from __future__ import annotations

import numpy as np

from harness.core.spatial import SE3
from harness.engine.cell import Cell
from harness.engine.goals import group_of, resolve_goal
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
        goal = _keep_rotation(goal, start, cell)
    cell.carry_out(cell.planner.plan_linear(group, start, goal, cell.current.options))


def _pose_of(goal: JointGoal, group: str, start: np.ndarray, cell: Cell) -> PoseGoal:
    """Where the TCP stands at joint positions: a line ends there, as Pilz's LIN does."""
    state = np.array(start)
    state[list(cell.description.group_indices(group))] = goal.positions
    link = cell.description.tcp_link
    pose = cell.kinematics.link_pose(cell.description.with_mimics(state), link)
    return PoseGoal(link, pose)


def _keep_rotation(goal: PositionGoal, start: np.ndarray, cell: Cell) -> PoseGoal:
    """A line to a point keeps the link turned as it is."""
    now = cell.kinematics.link_pose(start, goal.link)
    return PoseGoal(goal.link, SE3(now.rotation, goal.position), goal.position_tolerance)
