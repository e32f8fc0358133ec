"""wait and settle: simulated time passes."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import Settle, Wait

DEFAULT_TIMEOUT = 10.0  # [s] of simulation


@execute.handles(Wait)
def wait(step: Wait, cell: Cell) -> None:
    """Hold the last commands."""
    cell.simulator.hold(step.duration)


@execute.handles(Settle)
def settle(step: Settle, cell: Cell) -> None:
    """Hold until everything is slower than the limit.

    Raises:
        StepFailed: TIMED_OUT, when something still moves at the timeout.
    """
    cell.simulator.settle(step.max_velocity, step.timeout or DEFAULT_TIMEOUT)
