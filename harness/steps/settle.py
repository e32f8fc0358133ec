"""settle: everything comes to rest."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.step import Step
from harness.language.base import RestSpeed

DEFAULT_TIMEOUT = 10.0  # [s] of simulation


class Settle(Step):
    """Wait until everything is slower than a limit."""

    short = "max_velocity"

    verb: ClassVar[str] = "settle"
    plans: ClassVar[bool] = False
    keeps_arm_still: ClassVar[bool] = True

    max_velocity: RestSpeed = Field(
        default=1e-3,
        description="Every object [m/s] and every joint [rad/s] is slower than this at the end.",
    )

    def execute(self, cell: Cell) -> None:
        """Hold until everything is slower than the limit.

        Raises:
            StepFailed: TIMED_OUT, when something still moves at the timeout.
        """
        cell.simulator.settle(self.max_velocity, self.timeout or DEFAULT_TIMEOUT)
