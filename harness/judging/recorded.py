"""A run that refuses to be read where nothing was recorded."""

from __future__ import annotations

from collections.abc import Iterator
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

    def _refuse(self) -> NoReturn:
        raise object.__getattribute__(self, "_error")

    def __getattribute__(self, name: str) -> Any:
        if name in ("__class__", "_refuse"):
            return object.__getattribute__(self, name)
        return self._refuse()

    def __iter__(self) -> Iterator[Any]:
        self._refuse()

    def __len__(self) -> int:
        self._refuse()

    def __bool__(self) -> bool:
        self._refuse()

    def __contains__(self, _: object) -> bool:
        self._refuse()

    def __getitem__(self, _: object) -> Any:
        self._refuse()

    def __reversed__(self) -> Iterator[Any]:
        self._refuse()

    def __add__(self, _: object) -> Any:
        self._refuse()

    def __radd__(self, _: object) -> Any:
        self._refuse()

    def __eq__(self, _: object) -> bool:
        self._refuse()

    def __hash__(self) -> int:
        self._refuse()


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
