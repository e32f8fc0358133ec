"""Faults that an `inject` step began, and their effect."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from harness.core.details import Detail
from harness.recording.step_record import StepRecord

FaultKind = Literal[
    "friction", "gripper_effort", "joint_stall", "sensor_noise", "command_latency", "push"
]
Receipt = Literal["landed", "no_effect"]


@dataclass(frozen=True)
class InjectedFault(Detail):
    """A fault of the physics.

    Attributes:
        target: The object or joint that it concerns; empty where it concerns the whole robot.
        receipt: Whether it had an effect; None until the run has been observed.
        evidence: What shows the effect, or why there is none; None until then.
    """

    fault: FaultKind
    target: str
    before: Any
    after: Any
    receipt: Receipt | None = None
    evidence: str | None = None

    @property
    def name(self) -> str:
        """The fault in words."""
        kind = self.fault.replace("_", " ")
        return f"{kind} of {self.target}" if self.target else kind


@dataclass(frozen=True)
class InjectedFaults(Detail):
    """The faults that a step began, in its order."""

    faults: tuple[InjectedFault, ...]


def faults_of(step: StepRecord) -> tuple[InjectedFault, ...]:
    """The faults that a step began; none for most steps."""
    begun = step.result.find(InjectedFaults)
    return begun.faults if begun else ()
