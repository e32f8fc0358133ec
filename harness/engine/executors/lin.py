"""lin: Pilz's straight line."""

from __future__ import annotations

from dataclasses import replace

from harness.cell.cell import Cell
from harness.cell.goals import group_of, link_limits, resolve_goal
from harness.engine.registry import execute
from harness.spec.steps import Lin


@execute.handles(Lin)
def lin(step: Lin, cell: Cell) -> None:
    """Move the link on a straight line to the goal, turning at an even rate."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    goal = resolve_goal(step, group, cell)
    options = replace(cell.current.options, cartesian_limits=link_limits(step.cartesian_limits))
    cell.carry_out(cell.planner.plan_linear(group, cell.planning_start(), goal, options))
