"""What a case came to, as plain data: what the terminal, pytest and later pages tell of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from harness.core.errors import Problem
from harness.recording.run import Outcome, StepStatus, Verdict


@dataclass(frozen=True)
class ProgressEvent:
    """A sign of life of a running case.

    Attributes:
        index: Of the step, from 0.
        total: How many steps there are.
        step: Its summary in one line.
        status: What became of it, for `step_finished` and `judged`.
        sim_time: Simulation time so far [s].
        wall_time: On a clock that only goes forward [s]; shown, never judged.
        speed: Simulated over wall seconds of the step that finished; None where it is not known.
    """

    kind: Literal["compiled", "step_started", "step_finished", "judged", "written"]
    index: int
    total: int
    step: str
    status: str
    sim_time: float
    message: str
    wall_time: float = 0.0
    speed: float | None = None


@dataclass(frozen=True)
class StepLine:
    """A step in one line.

    Attributes:
        sim_time: Its duration in simulation time [s].
        line: In the scenario file, from 1; 0 if unknown.
        explanation: Why it failed, a line each: what became of every stage, what to do.
        path: Place in the expanded file: `steps[1].reach` is nested in `steps[1]`.
    """

    id: str
    verb: str
    summary: str
    status: StepStatus
    error_code: str = ""
    message: str = ""
    sim_time: float = 0.0
    line: int = 0
    explanation: tuple[str, ...] = ()
    path: str = ""


@dataclass(frozen=True)
class CaseResult:
    """The outcome of one case of a scenario file, with what a person needs to act on it.

    Attributes:
        file: As the user named it.
        case: Empty when the file has one case.
        sim_time: Length of the run [s].
        report_dir: Folder of its report; empty when none was written.
        page: The page in it; empty when none was written.
        problems: Of the file, when it is invalid; else what was predicted without physics.
        message: Why, when the harness or a native library broke.
        notes: Fallbacks worth a line: no renderer, no meshes.
        wall_times: Seconds of each part; never judged.
    """

    file: str
    case: str
    title: str
    outcome: Outcome
    digest: str = ""
    seed: int = 0
    sim_time: float = 0.0
    report_dir: str = ""
    page: str = ""
    steps: tuple[StepLine, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    problems: tuple[Problem, ...] = ()
    message: str = ""
    notes: tuple[str, ...] = ()
    wall_times: Mapping[str, float] = field(default_factory=dict[str, float])
