"""allow_collisions: pairs may touch while the nested steps run."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import AllowCollisions


@execute.handles(AllowCollisions)
def allow_collisions(step: AllowCollisions, cell: Cell) -> None:
    """Allow the pairs, run the nested steps, and check the pairs again, whatever happened."""
    cell.notes.result["allowed_collisions"] = [list(pair) for pair in step.pairs]
    cell.scene.set_allowed(step.pairs, allowed=True)
    cell.allowed.append(step.pairs)
    try:
        cell.run_children()
    finally:
        cell.allowed.pop()
        cell.scene.set_allowed(step.pairs, allowed=False)
        for around in cell.allowed:  # may name the same pairs
            cell.scene.set_allowed(around, allowed=True)
