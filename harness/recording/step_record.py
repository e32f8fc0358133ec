"""The record of one step: its times, its motion and its failure."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Literal

from harness.core.details import Details
from harness.core.trajectory import JointTrajectory

StepStatus = Literal["passed", "failed", "expected error", "not reached"]


@dataclass(frozen=True)
class StepRecord:
    """One executed (or not executed) step.

    Attributes:
        id: The file's `id`, else its path (`steps[3]`, `steps[3].lift`).
        path: Place in the expanded file; the step's seed is made from it.
        verb: The verb: `move_to`, `lin`, ...
        summary: One line for a person: `move_to mogi_home`.
        line: The line in the scenario file, from 1; 0 if unknown.
        error_code: MoveIt error name of its failure, expected or not; empty when it succeeded.
        expected_error: What the file expects; empty when success is expected.
        start_time: The simulated time at its start [s].
        end_time: The simulated time at its end [s].
        start_index: First sample of the step.
        end_index: One past its last sample.
        trajectory: The commanded trajectory; None for steps without a motion.
        planner: The numbers of its plan; `harness.recording.plan_statistics` has the parts.
        explanation: IK solutions and their results, blocking pairs, nearest pose;
            `harness.recording.explanation` and the records of failures have the parts.
        result: What the step reports; `harness.recording.step_results` has the common parts.
        arm: The arm that carried it out, of a robot with several.
    """

    id: str
    path: str
    verb: str
    summary: str
    line: int
    status: StepStatus
    start_time: float = 0.0
    end_time: float = 0.0
    start_index: int = 0
    end_index: int = 0
    error_code: str = ""
    expected_error: str = ""
    message: str = ""
    trajectory: JointTrajectory | None = None
    planner: Details = field(default_factory=Details)
    explanation: Details = field(default_factory=Details)
    result: Details = field(default_factory=Details)
    arm: str = ""

    @property
    def title(self) -> str:
        """What people call it: the id that the file gives, else its summary."""
        return step_title(self.id, self.path, self.summary or self.verb)

    @property
    def slug(self) -> str:
        """The id as part of a file name."""
        return re.sub(r"[^a-z0-9]+", "-", self.id.lower()).strip("-")[:48] or "step"


def step_title(step_id: str, path: str, summary: str) -> str:
    """The id that the file gives; where it gives none, the id is the path."""
    return summary if step_id in ("", path) else step_id


def is_nested(inner: str, outer: str) -> bool:
    """Whether the step at one path is nested in the step at another."""
    return inner.startswith((f"{outer}.", f"{outer}["))
