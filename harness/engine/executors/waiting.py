"""wait and settle: simulated time passes."""

from __future__ import annotations

from harness.core.errors import StepFailed
from harness.engine.cell import Cell
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
    timeout = step.timeout or DEFAULT_TIMEOUT
    if not cell.simulator.settle(step.max_velocity, timeout):
        raise StepFailed(
            "TIMED_OUT",
            f"something is still faster than {step.max_velocity:g} m/s (or rad/s)"
            f" after {timeout:g} s",
        )
