"""Progress of a running case: one class for each event."""

from __future__ import annotations

from dataclasses import dataclass

from harness.recording.run import Run
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult


@dataclass(frozen=True)
class ProgressEvent:
    """An event of a running case, of which there are the classes below."""


@dataclass(frozen=True)
class Compiled(ProgressEvent):
    """The first step is about to begin."""


@dataclass(frozen=True)
class StepProgress(ProgressEvent):
    """A step begins or ends.

    Attributes:
        index: The index of the step, from 0; -1 for a step inside another one.
        total: The number of steps of the file.
        sim_time: Simulation time so far [s].
        wall_time: The time on a monotonic clock [s]; shown, never judged.
    """

    index: int
    total: int
    step: str
    sim_time: float
    wall_time: float = 0.0


@dataclass(frozen=True)
class StepStarted(StepProgress):
    """A step begins."""


@dataclass(frozen=True)
class StepFinished(StepProgress):
    """A step is over.

    Attributes:
        message: Why it failed; empty where it did not.
        speed: Simulated over wall seconds of the step; None where it is not known.
    """

    status: str = "passed"
    message: str = ""
    speed: float | None = None


@dataclass(frozen=True)
class Working(ProgressEvent):
    """Work that takes time before or after the steps.

    Attributes:
        what: The work in a few words.
        done: The number of its parts that are done.
        total: The number of its parts; 0 where that is not known.
        is_slow: Whether it is work that users should know of without a status line, too.
    """

    what: str
    done: int = 0
    total: int = 0
    is_slow: bool = False


@dataclass(frozen=True)
class Judged(ProgressEvent):
    """The outcome is known, before the report is written."""

    result: CaseResult


@dataclass(frozen=True)
class Drawing(ProgressEvent):
    """The pictures of the report are being drawn; the event stays in the process of the case."""

    run: Run
    verdicts: tuple[Verdict, ...]
