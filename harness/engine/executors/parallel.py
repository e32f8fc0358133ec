"""parallel: the gripper moves while the arm does."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.engine.executors.gripper import command_of
from harness.engine.registry import execute
from harness.spec.steps import Gripper, Parallel


@execute.handles(Parallel)
def parallel(step: Parallel, cell: Cell) -> None:
    """Start the gripper with the arm; then wait until it has arrived or stalled as well."""
    gripper = next(child for child in step.steps if isinstance(child, Gripper))
    target, effort = command_of(gripper, cell)
    cell.simulator.start_gripper(target, effort)
    children = cell.current.children
    motion_first = sorted(children, key=lambda child: isinstance(child.spec, Gripper))
    cell.run_children(motion_first)
