"""Who commands the robot in the step `external`: ROS 2 nodes, a recording, or no program."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from harness.core.errors import StepFailed
from harness.ports.external import ExternalControl, ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord
from harness.session.prepare import Prepared

if TYPE_CHECKING:
    from harness.session.timed_simulator import TimedSimulator


class ExternalSession(ExternalControl, Protocol):
    """External programs over a whole run."""

    @property
    def commands(self) -> tuple[CommandRecord, ...]:
        """Everything that they commanded, in order."""
        ...

    def refusal(self) -> str:
        """Why a run that did not pass must not be held against them; empty where it may."""
        ...


MakeSession = Callable[[Prepared, "TimedSimulator"], ExternalSession]
"""Makes the session for a scenario at its start."""


class NoPrograms:
    """The session of a run without external programs."""

    commands: tuple[CommandRecord, ...] = ()

    def __init__(self, *_start: object) -> None: ...

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
        """Nothing."""
        return ""
