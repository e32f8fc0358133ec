"""Faults that an `inject` step began, and their effect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from harness.recording.run import StepRecord

FaultKind = Literal[
    "friction", "gripper_effort", "joint_stall", "sensor_noise", "command_latency", "push"
]
Receipt = Literal["landed", "no_effect"]


@dataclass(frozen=True)
class InjectedFault:
    """A fault of the physics.

    Attributes:
        fault: The kind of the fault.
        target: The object or joint that it concerns; empty where it concerns the whole robot.
        before: The value that it replaces.
        after: The value that it sets.
        receipt: Whether it had an effect; None until the run has been observed.
        evidence: What shows the effect, or why there is none.
    """

    fault: FaultKind
    target: str
    before: Any
    after: Any
    receipt: Receipt | None = None
    evidence: str = ""

    @property
    def name(self) -> str:
        """The fault in words."""
        kind = self.fault.replace("_", " ")
        return f"{kind} of {self.target}" if self.target else kind

    def plain(self) -> dict[str, Any]:
        """As plain data for a step's record."""
        begun = {
            "fault": self.fault,
            "target": self.target,
            "before": self.before,
            "after": self.after,
        }
        if self.receipt is None:
            return begun
        return {**begun, "receipt": self.receipt, "evidence": self.evidence}


def faults_of(step: StepRecord) -> tuple[InjectedFault, ...]:
    """The faults that a step began; none for most steps."""
    entries: tuple[Mapping[str, Any], ...] = tuple(step.result.get("faults", ()))
    return tuple(InjectedFault(**entry) for entry in entries)
