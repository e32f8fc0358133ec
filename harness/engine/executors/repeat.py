"""repeat: the same steps several times."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import Repeat


@execute.handles(Repeat)
def repeat(step: Repeat, cell: Cell) -> None:
    """Run every time through, one after the other; each step has a seed and a record of its own."""
    cell.notes.result["times"] = step.times
    cell.run_children()
