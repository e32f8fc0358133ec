"""What the step `external` requires of programs outside, and how their time ended."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.core.details import Detail


@dataclass(frozen=True)
class ExternalRequest:
    """What a step requires of external programs.

    Attributes:
        step: Id of the step.
        line: Its line in the file.
        timeout: Simulated time after which it has failed [s].
        until: The expectation whose passing ends it; None: it ends with the launched program.
        launch: Name of the command that is started; empty for none.
        cell: The robot cell, whose planning scene programs may change.
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
