"""wait: simulated time passes, for a duration or until an expectation holds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.errors import StepFailed
from harness.judging.ends import check_end, holds_now
from harness.language.base import PositiveDuration
from harness.language.expectation import AnyExpectation, ExpectationFields
from harness.ports.simulation import RecordingSimulator
from harness.recording.execution_failures import TimeoutFailure

DEFAULT_TIMEOUT = 60.0  # [s] of simulation
LOOK_EVERY, LOOK_SHARE = 0.02, 0.01
"""Simulated time between two looks at `until` [s], and at least this share of the step's time: a
look reads the whole record."""


class Wait(Step):
    """Let simulated time pass: for a duration, or until an expectation holds.

    With `until`, the step fails after its `timeout`, a minute if that is not given; it may stand
    inside `wait:`, too. The expectation is evaluated every 20 ms of simulated time, and after two
    seconds whenever the step has become a hundredth longer. Where it holds at once, the report says
    so among its findings.
    """

    short = "duration"
    one_of = ("duration", "until")

    verb: ClassVar[str] = "wait"
    plans: ClassVar[bool] = False
    synonyms = ("sleep", "delay", "pause")
    keeps_arm_still: ClassVar[bool] = True
    keys_inside: ClassVar[tuple[str, ...]] = ("timeout",)

    duration: PositiveDuration | None = Field(
        default=None, description="This much simulated time passes [s]."
    )
    until: AnyExpectation | None = Field(
        default=None, description="The step ends when this expectation holds."
    )

    def summary(self) -> str:
        return f"{self.duration:g} s" if self.until is None else f"until {self.until.word}"

    def ends(self) -> Iterator[ExpectationFields]:
        if self.until is not None:
            yield self.until

    def check(self, at: At) -> None:
        key = "timeout" if self.duration is None else "duration"
        at.scope.take_time(self.duration or self.timeout or DEFAULT_TIMEOUT, at.key(key))
        if self.until is not None:
            check_end(self.until, at)

    def execute(self, cell: Cell) -> None:
        """Hold the last commands.

        Raises:
            StepFailed: TIMED_OUT, when `until` did not hold in time.
        """
        simulator = cell.simulator
        if self.until is None:
            simulator.hold(self.duration or 0.0)
            return
        if not isinstance(simulator, RecordingSimulator):
            return  # without physics it holds at once
        timeout = self.timeout or DEFAULT_TIMEOUT
        since = begin, _ = simulator.time, simulator.sample_count - 1
        looked = 0
        while not holds_now(self.until, cell, simulator, since=since, looked=looked):
            looked = simulator.sample_count - 1
            elapsed = simulator.time - begin
            left = timeout - elapsed
            if left < simulator.timestep / 2:
                raise StepFailed(
                    "TIMED_OUT",
                    f"`until` did not hold within {timeout:g} s",
                    TimeoutFailure(elapsed, timeout),
                )
            simulator.hold(min(left, max(LOOK_EVERY, LOOK_SHARE * elapsed)))
