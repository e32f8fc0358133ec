"""sequence: Pilz's motions one after the other, blended, all or none."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.cell.goals import arc_point, group_of, link_limits, resolve_goal
from harness.engine.registry import execute
from harness.ports import SequenceItem
from harness.spec.steps import Sequence
from harness.spec.steps import SequenceItem as ItemSpec


@execute.handles(Sequence)
def sequence(step: Sequence, cell: Cell) -> None:
    """Resolve every goal as things stand now, plan all motions, follow them."""
    cell.sync_scene()
    group = group_of(cell, step.group)
    items = [_item(item, group, cell) for item in step.items]
    cell.carry_out(
        cell.planner.plan_sequence(group, cell.planning_start(), items, cell.current.options)
    )


def _item(item: ItemSpec, group: str, cell: Cell) -> SequenceItem:
    radius = item.blend_radius
    if item.circ is not None:
        goal, point = resolve_goal(item.circ, group, cell), arc_point(item.circ, cell)
        limits = link_limits(item.circ.cartesian_limits)
        return SequenceItem("circ", goal, point, radius, limits)
    if item.lin is not None:
        limits = link_limits(item.lin.cartesian_limits)
        return SequenceItem("lin", resolve_goal(item.lin, group, cell), None, radius, limits)
    if item.ptp is not None:
        return SequenceItem("ptp", resolve_goal(item.ptp, group, cell), None, radius)
    raise ValueError("the model has one motion")
