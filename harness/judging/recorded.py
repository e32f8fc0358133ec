"""A run that refuses to be read where nothing was recorded."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NoReturn, cast

from harness.judging.window import NotObservable
from harness.recording.run import AttachmentRecord, Run
from harness.recording.signals import Signals

WORDS = {
    "joint_velocities": "the velocities of the joints",
    "joint_efforts": "the efforts of the joints",
    "joint_commands": "the commanded positions of the joints",
    "joint_command_velocities": "the commanded velocities of the joints",
    "contact_forces": "contacts",
    "presses": "the directions in which the fingers press",
    "support_forces": "what carries what",
    "slides": "how far objects slide",
    "clearances": "distances",
    "planned_clearances": "planned distances",
    "frictions": "the friction forces of the robot",
    "link_overlaps": "overlaps of links",
}


class Unreadable:
    """Stands for a collection that was not recorded: every way to read it raises the same error."""

    def __init__(self, error: Exception) -> None:
        object.__setattr__(self, "_error", error)

    def _refuse(self, *_: object) -> NoReturn:
        raise object.__getattribute__(self, "_error")

    def __getattribute__(self, name: str) -> Any:
        if name == "__class__":
            return object.__getattribute__(self, name)
        raise object.__getattribute__(self, "_error")

    # Operators look their methods up in the class.
    __iter__ = __len__ = __bool__ = __contains__ = __getitem__ = __reversed__ = _refuse
    __add__ = __radd__ = _refuse
    __eq__ = __hash__ = _refuse  # pyright: ignore[reportAssignmentType]


class _Guarded:
    """Signals; reading one that is missing raises NotObservable."""

    def __init__(self, signals: Signals, missing: tuple[str, ...]) -> None:
        self._signals = signals
        self._missing = missing

    def __getattr__(self, name: str) -> Any:
        if name in self._missing:
            raise NotObservable(f"{WORDS.get(name, name)} were not recorded")
        return getattr(self._signals, name)


def guard_unrecorded(run: Run) -> Run:
    """The same run, in which reading what was not recorded raises an error."""
    if not run.unrecorded:
        return run
    if "attachments" in run.unrecorded:
        error = NotObservable("what the planning scene attached was not recorded")
        run = replace(run, attachments=cast("tuple[AttachmentRecord, ...]", Unreadable(error)))
    return replace(run, signals=cast("Signals", _Guarded(run.signals, run.unrecorded)))
