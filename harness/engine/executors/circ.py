"""circ: Pilz's arc."""

from __future__ import annotations

from dataclasses import replace

from harness.cell.cell import Cell
from harness.cell.goals import arc_point, group_of, link_limits, resolve_goal
from harness.engine.registry import execute
from harness.spec.steps import Circ


@execute.handles(Circ)
def circ(step: Circ, cell: Cell) -> None:
    """Move the link on an arc to the goal, turning at an even rate."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    goal, point = resolve_goal(step, group, cell), arc_point(step, cell)
    options = replace(cell.current.options, cartesian_limits=link_limits(step.cartesian_limits))
    cell.carry_out(cell.planner.plan_circular(group, cell.planning_start(), goal, point, options))
