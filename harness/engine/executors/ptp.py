"""ptp: Pilz's synchronised joint motion."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.cell.goals import group_of, resolve_goal
from harness.core.errors import PlanningFailed
from harness.engine.registry import execute
from harness.ports import JointGoal
from harness.spec.steps import Ptp


@execute.handles(Ptp)
def ptp(step: Ptp, cell: Cell) -> None:
    """Move all joints together, straight in joint space; a pose goal takes the nearest solution."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    start = cell.planning_start()
    goal = resolve_goal(step, group, cell)
    if isinstance(goal, JointGoal):
        positions = goal.positions
    else:
        cell.planner.check_goal(group, start, goal, cell.current.options)
        solutions = cell.kinematics.solve(group, goal, start, cell.current.options.seed)
        if not solutions:
            raise PlanningFailed("NO_IK_SOLUTION", "no joint positions reach the goal")
        positions = solutions[0]
    plan = cell.planner.plan_joint_motion(
        group, start, positions, cell.current.options, step.duration
    )
    cell.carry_out(plan)
