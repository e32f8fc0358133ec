"""move_to: plan a collision-free motion, then follow it."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.cell.goals import group_of, path_constraints, resolve_goals
from harness.engine.registry import execute
from harness.spec.steps import MoveTo


@execute.handles(MoveTo)
def move_to(step: MoveTo, cell: Cell) -> None:
    """Plan from where the arm stands to the goal, time the path, track it."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    goal = resolve_goals(step, group, cell)
    held = None
    if step.path_constraints is not None:
        held = path_constraints(step.path_constraints, cell)
    start = cell.planning_start()
    cell.carry_out(cell.planner.plan(group, start, goal, cell.current.options, held))
