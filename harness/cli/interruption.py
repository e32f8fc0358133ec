"""Whether Ctrl-C, or a signal that is handled like it, has ended a command."""

from __future__ import annotations

from types import FrameType

_signals: list[int] = []


def interrupt(number: int, _frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, as the handler of a signal."""
    _signals.append(number)
    raise KeyboardInterrupt


def is_interrupted() -> bool:
    """Whether that has happened; a native library may have raised another exception from it."""
    return bool(_signals)
