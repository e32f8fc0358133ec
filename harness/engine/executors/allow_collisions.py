"""allow_collisions: pairs may touch while the nested steps run."""

from __future__ import annotations

from harness.engine.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import AllowCollisions


@execute.handles(AllowCollisions)
def allow_collisions(step: AllowCollisions, cell: Cell) -> None:
    """Allow the pairs, run the nested steps, and check the pairs again, whatever happened."""
    current, notes = cell.current, cell.notes
    notes.result["allowed_collisions"] = [list(pair) for pair in step.pairs]
    cell.scene.set_allowed(step.pairs, allowed=True)
    try:
        cell.run_steps(current.children)
    finally:
        cell.scene.set_allowed(step.pairs, allowed=False)
        cell.step, cell.notes = current, notes
