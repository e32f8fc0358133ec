"""A run whose signals refuse to be read where nobody recorded them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, cast

from harness.assertions.window import NotObservable
from harness.recording.run import AttachmentRecord, Run, Signals

WORDS = {
    "joint_velocities": "the velocities of the joints",
    "joint_efforts": "the efforts of the joints",
    "joint_commands": "the commanded positions of the joints",
    "joint_command_velocities": "the commanded velocities of the joints",
    "contact_forces": "contacts",
    "presses": "the directions in which the fingers press",
    "support_forces": "what carries what",
    "clearances": "distances",
    "planned_clearances": "planned distances",
}


class _Guarded:
    """Signals; reading one that is missing raises NotObservable."""

    def __init__(self, signals: Signals, missing: tuple[str, ...]) -> None:
        self._signals = signals
        self._missing = missing

    def __getattr__(self, name: str) -> Any:
        if name in self._missing:
            raise NotObservable(f"{WORDS.get(name, name)} were not recorded")
        return getattr(self._signals, name)


class _NoAttachments(tuple[AttachmentRecord, ...]):
    """What the planner attached, where nobody recorded it; looking at it raises NotObservable."""

    __slots__ = ()

    def __iter__(self) -> Iterator[AttachmentRecord]:
        raise NotObservable("what the planning scene attached was not recorded")


def guarded(run: Run) -> Run:
    """The same run; a signal that it does not have cannot be read as if nothing had happened."""
    if not run.unrecorded:
        return run
    if "attachments" in run.unrecorded:
        run = replace(run, attachments=_NoAttachments())
    return replace(run, signals=cast("Signals", _Guarded(run.signals, run.unrecorded)))
