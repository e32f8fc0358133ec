"""wait: simulated time passes."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.language.base import PositiveDuration
from harness.language.step import Step


class Wait(Step):
    """Let simulated time pass."""

    short = "duration"

    verb: ClassVar[str] = "wait"
    synonyms = ("sleep", "delay", "pause")
    keeps_arm_still: ClassVar[bool] = True

    duration: PositiveDuration = Field(description="This much simulated time passes [s].")

    def summary(self) -> str:
        return f"{self.duration:g} s"

    def check(self, at: At) -> None:
        at.scope.take_time(self.duration, at.key("duration"))

    def execute(self, cell: Cell) -> None:
        """Hold the last commands."""
        cell.simulator.hold(self.duration)
