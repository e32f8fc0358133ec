"""Where executors register: `execute` maps a step's model to the function that carries it out."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.core.dispatch import Dispatch
from harness.spec.steps import Include

execute: Dispatch[Cell, None] = Dispatch()


def is_available(verb: type) -> bool:
    """Whether a step does what it says; the loader puts an included file's steps in its place."""
    return verb in execute or verb is Include
