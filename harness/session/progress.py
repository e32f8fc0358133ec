"""Progress events of one case."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from harness.cell.program import Program, ProgramStep
from harness.ports.simulation import Simulator
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun
from harness.reporting.result import CaseResult, ProgressEvent
from harness.session.execute import StepEvent

Notify = Callable[[ProgressEvent], None]


@dataclass(frozen=True)
class Progress:
    """Reports how far a case is.

    Attributes:
        notify: Called with every event.
        program: The program that is executed.
    """

    notify: Notify
    program: Program

    def compiled(self) -> None:
        """Report that the first step is about to begin."""
        program = self.program
        self.notify(ProgressEvent("compiled", 0, len(program.steps), program.title, "", 0.0, ""))

    def activity(self, what: str, done: int = 0, total: int = 0) -> None:
        """Report work that is no step: see `harness.core.activity.Activity`."""
        self.notify(ProgressEvent("activity", done, total, what, "", 0.0, ""))

    def step(
        self,
        simulator: Simulator,
        kind: StepEvent,
        step: ProgramStep,
        record: StepRecord | None,
    ) -> None:
        """Report that a step begins, or its result."""
        places = {each.path: index for index, each in enumerate(self.program.steps)}
        event = ProgressEvent(
            kind,
            index=places.get(step.path, -1),
            total=len(places),
            step=step.summary,
            status=record.status if record else "",
            sim_time=simulator.time,
            message=record.message if record else "",
            wall_time=time.monotonic(),
        )
        self.notify(event)

    def judged(self, result: CaseResult) -> None:
        """Report the outcome, before the report is written."""
        total = len(self.program.steps)
        event = ProgressEvent(
            "judged", total, total, "", result.outcome, result.sim_time, "", result=result
        )
        self.notify(event)

    def written(self, stored: StoredRun, folder: str) -> None:
        """Report where the run was written."""
        seconds = stored.run.duration
        self.notify(ProgressEvent("written", 0, 0, "", stored.outcome, seconds, folder))
