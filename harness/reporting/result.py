"""The result of a case as plain data, for the terminal, pytest and the pages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.core.errors import Problem
from harness.recording.explanation import recorded_explanation
from harness.recording.run import Outcome
from harness.recording.step_record import StepRecord, StepStatus, step_title
from harness.recording.stored_run import PAGE
from harness.recording.verdict import Verdict
from harness.reporting.explanation import explanation_lines


@dataclass(frozen=True)
class StepLine:
    """A step in one line.

    Attributes:
        sim_time: Its duration in simulation time [s].
        line: The line in the scenario file, from 1; 0 if unknown.
        explanation: Why it failed, a line each: the result of every stage, what to do.
        path: Place in the expanded file: `steps[1].reach` is nested in `steps[1]`.
        advice: What the user can do about its failure; empty where nothing is known.
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
    advice: str = ""

    @property
    def title(self) -> str:
        """What people call it: the id that the file gives, else its summary."""
        return step_title(self.id, self.path, self.summary or self.verb)

    @classmethod
    def of(cls, step: StepRecord) -> StepLine:
        """A recorded step in one line."""
        return cls(
            id=step.id,
            verb=step.verb,
            summary=step.summary,
            status=step.status,
            error_code=step.error_code,
            message=step.message,
            sim_time=step.end_time - step.start_time,
            line=step.line,
            explanation=explanation_lines(step.explanation, step.message),
            path=step.path,
            advice=recorded_explanation(step.explanation).advice or "",
        )


@dataclass(frozen=True)
class CaseResult:
    """The outcome of one case of a scenario file, with what a person needs to act on it.

    Attributes:
        file: The path as the user named it.
        case: Empty when the file has one case.
        sim_time: Length of the run [s].
        report_dir: Folder of its report; empty when none was written.
        page: The page in it; empty when none was written.
        problems: The problems of the file, when it is invalid; else what was predicted without
            physics.
        message: Why, when the harness or a native library broke; in a strict run the warnings.
        notes: Worth a line: no renderer, no meshes, nothing expected, an angle like 90 rad.
        overlap: Depth of the deepest pair of bodies that overlap at the start [m]; 0: none do.
        is_idle: Whether the arm did not move before the run ended.
        redraws: How often the sample was drawn again because objects overlapped.
        values: What varies as it was drawn at last, path -> value; empty when drawn once.
        wall_times: Seconds of each part; never judged.
        inputs: The files that it follows from, absolute path -> hash, which is empty where there
            was no such file. They are removed from a result that is stored.
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
    overlap: float = 0.0
    is_idle: bool = False
    redraws: int = 0
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    wall_times: Mapping[str, float] = field(default_factory=dict[str, float])
    inputs: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def further_pages(self) -> list[str]:
        """The pages in its folder but its own, which other reporters wrote."""
        pages = Path(self.report_dir).glob("*.html") if self.report_dir else ()
        return sorted(str(page) for page in pages if page.name != PAGE)

    @property
    def name(self) -> str:
        """The title, and the case where the file has several."""
        return f"{self.title} [{self.case}]" if self.case else self.title
