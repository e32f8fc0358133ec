"""Programs outside that command the robot."""

from __future__ import annotations

from typing import Protocol

from harness.recording.commands import CommandRecord


class ExternalSession(Protocol):
    """External programs over a whole run; the step that hands the robot over knows more of them."""

    @property
    def commands(self) -> tuple[CommandRecord, ...]:
        """Everything that they commanded, in order."""
        ...

    def refusal(self) -> str:
        """Why a run that did not pass must not be held against them; empty where it may."""
        ...
