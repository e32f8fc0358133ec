"""Progress events of one case."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from harness.cell.program import Program, ProgramStep
from harness.ports.simulation import Simulator
from harness.recording.step_record import StepRecord
from harness.reporting.progress_events import ProgressEvent, StepFinished, StepStarted, Working
from harness.reporting.reporter import Reports

Notify = Callable[[ProgressEvent], None]


@dataclass(frozen=True)
class Progress:
    """The events of a case: its reporters hear all of them, others those that are small.

    Attributes:
        outside: Hears them in other processes too.
    """

    outside: Notify
    reports: Reports
    program: Program

    def notify(self, event: ProgressEvent) -> None:
        self.reports.hear(event)
        self.outside(event)

    def activity(self, what: str, done: int = 0, total: int = 0) -> None:
        """Report work that is no step: see `harness.core.activity.Activity`."""
        self.notify(Working(what, done, total))

    def step(self, simulator: Simulator, step: ProgramStep, record: StepRecord | None) -> None:
        """Report that a step begins, or its result."""
        places = {each.path: index for index, each in enumerate(self.program.steps)}
        place = places.get(step.path, -1), len(places)
        at = step.summary, simulator.time, time.monotonic()
        if record is None:
            self.notify(StepStarted(*place, *at))
        else:
            self.notify(StepFinished(*place, *at, record.status, record.message))
