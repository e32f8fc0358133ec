"""Where executors register: `execute` maps a step's model to the function that carries it out."""

from __future__ import annotations

from harness.core.registry import Registry
from harness.engine.cell import Cell

execute: Registry[Cell, None] = Registry()
