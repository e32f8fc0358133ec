"""cartesian_path: straight through waypoints, as far as goes."""

from __future__ import annotations

from dataclasses import replace

from harness.cell.cell import Cell
from harness.cell.goals import group_of, link_limits, resolve_goal
from harness.core.errors import PlanningFailed
from harness.engine.registry import execute
from harness.ports import CartesianPathOptions, JointGoal, JumpThreshold, PoseGoal, PositionGoal
from harness.spec.goals import GoalFields
from harness.spec.poses import Position
from harness.spec.steps import CartesianPath, Waypoint

REPORTED = ("fraction", "largest_joint_step", "deviation")


@execute.handles(CartesianPath)
def cartesian_path(step: CartesianPath, cell: Cell) -> None:
    """Follow the lines and note how far they went, how far joints stepped, how far off it was."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    goals = [_goal(waypoint, step.link, group, cell) for waypoint in step.waypoints]
    jump = JumpThreshold(step.jump_threshold.revolute, step.jump_threshold.prismatic)
    wanted = CartesianPathOptions(step.max_step, step.precision, step.min_fraction, jump)
    options = replace(cell.current.options, cartesian_limits=link_limits(step.cartesian_limits))
    try:
        plan = cell.planner.plan_cartesian_path(
            group, cell.planning_start(), goals, wanted, options
        )
    except PlanningFailed as failure:
        cell.notes.result.update({k: failure.facts[k] for k in REPORTED if k in failure.facts})
        raise
    cell.carry_out(plan)


def _goal(waypoint: Waypoint, link: str | None, group: str, cell: Cell) -> PoseGoal | PositionGoal:
    """The waypoint in the world; without a rotation the link stays turned as it is."""
    if waypoint.rpy is None and waypoint.quat_xyzw is None and waypoint.quat_wxyz is None:
        position = Position(xyz=waypoint.xyz, frame=waypoint.frame)
        fields = GoalFields(position=position, link=link)
    else:
        fields = GoalFields(pose=waypoint, link=link)
    goal = resolve_goal(fields, group, cell)
    if isinstance(goal, JointGoal):
        raise TypeError("a waypoint is a pose")
    return goal
