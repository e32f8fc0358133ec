"""Who commands the robot in the step `external`: ROS 2 nodes, a recording, or no program."""

from __future__ import annotations

from typing import Protocol

from harness.core.errors import StepFailed
from harness.ports.external import ExternalControl, ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord


class ExternalSession(ExternalControl, Protocol):
    """External programs over a whole run."""

    @property
    def commands(self) -> tuple[CommandRecord, ...]:
        """Everything that they commanded, in order."""
        ...

    def refusal(self) -> str:
        """Why a run that did not pass must not be held against them; empty where it may."""
        ...


class NoPrograms:
    """The session of a run without external programs."""

    commands: tuple[CommandRecord, ...] = ()

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Refuse.

        Raises:
            StepFailed: COMMUNICATION_FAILURE, always.
        """
        del request
        raise StepFailed(
            "COMMUNICATION_FAILURE",
            "this step hands the arm to ROS 2 nodes; run the scenario with"
            " `harness grade SCENARIO --node COMMAND`, with `harness bridge SCENARIO`, or with"
            " `harness run SCENARIO --node COMMAND`",
        )

    def refusal(self) -> str:
        return ""
