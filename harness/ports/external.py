"""Programs outside that command the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from harness.core.details import Detail


@dataclass(frozen=True)
class ExternalRequest:
    """What a step requires of external programs.

    Attributes:
        step: Id of the step.
        line: Its line in the file.
        timeout: Simulated time after which it has failed [s].
        until: The expectation (`harness.judging.expectation.Expectation`) whose passing ends
            it; None: it ends with the launched program.
        launch: Name of the command that is started; empty for none.
        cell: The robot cell (`harness.cell.cell.Cell`), whose planning scene programs may change.
    """

    step: str
    line: int
    timeout: float
    until: object | None = None
    launch: str = ""
    cell: object | None = None


@dataclass(frozen=True)
class ExternalResult(Detail):
    """How external programs' time ended.

    Attributes:
        ended_by: `until`, `timeout`, `exit` (of the launched program) or `stopped` (by the user).
        detail: One sentence for a person; empty where there is nothing to add.
    """

    ended_by: Literal["until", "timeout", "exit", "stopped"]
    commands: int
    detail: str = ""


class ExternalControl(Protocol):
    """Hands the robot over to programs outside, or to a recording of their commands."""

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Let them command the robot until the request's end.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; no program can be reached.
        """
        ...
