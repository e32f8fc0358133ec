"""move_relative: Task Constructor's straight move by a distance."""

from __future__ import annotations

import numpy as np

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.engine.registry import execute
from harness.spec.steps import MoveRelative


@execute.handles(MoveRelative)
def move_relative(step: MoveRelative, cell: Cell) -> None:
    """Move the link along a direction, or turn it about an axis, as far as asked."""
    cell.sync_scene()
    twist = np.zeros(6)
    if step.direction is not None:
        twist[:3] = cell.world_direction(step.direction)
        most = step.distance or step.max_distance or 0.0
        least = step.distance or step.min_distance or 0.0
    elif step.rotation is not None and step.angle is not None:
        twist[3:] = cell.world_direction(step.rotation)
        least = most = step.angle
    else:
        raise ValueError("the model has a direction or a rotation")
    plan = cell.planner.plan_relative(
        group_of(cell, step.group),
        cell.planning_start(),
        step.link or cell.description.tcp_link,
        twist,
        (least, most),
        cell.current.options,
    )
    cell.carry_out(plan)
