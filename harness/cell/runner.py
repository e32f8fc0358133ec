"""What carries out the steps that a step is made of, and how a step ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from harness.cell.program import ProgramStep
from harness.core.errors import StepFailed
from harness.recording.step_record import StepRecord

OnStep = Callable[[ProgramStep, StepRecord | None], None]  # None: it begins


class RunEndedError(Exception):
    """A step failed in a way that nothing expected; carries the failure up through nesting.

    Attributes:
        failure: The failure of the innermost step.
    """

    def __init__(self, failure: StepFailed, summary: str) -> None:
        self.failure, self.summary = failure, summary
        super().__init__(str(failure))


Failure = StepFailed | RunEndedError
End = Callable[[Failure | None], None]  # completes the record of a step


class Runner(Protocol):
    """Carries out steps and records them."""

    on_step: OnStep
    records: list[StepRecord]

    def run(self, steps: Sequence[ProgramStep]) -> None:
        """Carry out steps in order.

        Raises:
            RunEndedError: One of them failed.
        """
        ...

    def begin(self, step: ProgramStep) -> End:
        """Begin the record of a step; returns what completes it from the cell's notes."""
        ...
