"""Ctrl-C, and the signals that are handled like it, as KeyboardInterrupt."""

from __future__ import annotations

import signal
import sys
from types import FrameType
from typing import Any

IMPORT_SYSTEM = "<frozen importlib._bootstrap>"
RETRY_SECONDS = 0.01  # [s] until it is tried again, where a module is being imported

_signals: list[int] = []


def interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, as the handler of a signal.

    A native module whose import is interrupted raises an ImportError of its own, or swallows the
    interruption. So the first signal waits until no module is being imported; a second does not.
    Where Python ignores it, as in a function that a fork calls, it is raised again.
    """
    _signals.append(number)
    sys.unraisablehook = _raise_again
    if len(_signals) == 1:
        signal.signal(signal.SIGALRM, _raise_unless_importing)
        _raise_unless_importing(number, frame)
    else:
        signal.signal(signal.SIGALRM, _nothing)  # or the first would interrupt what handles this
        raise KeyboardInterrupt


def _raise_again(ignored: Any) -> None:
    if not isinstance(ignored.exc_value, KeyboardInterrupt):
        return sys.__unraisablehook__(ignored)
    signal.signal(signal.SIGALRM, _raise_unless_importing)
    signal.setitimer(signal.ITIMER_REAL, RETRY_SECONDS)
    return None


def _nothing(_number: int, _frame: FrameType | None) -> None: ...


def is_interrupted() -> bool:
    """Whether such a signal has come; native code may have raised another exception from it."""
    return bool(_signals)


def _raise_unless_importing(_number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, or try again shortly."""
    while frame is not None:
        if frame.f_code.co_filename == IMPORT_SYSTEM:
            signal.setitimer(signal.ITIMER_REAL, RETRY_SECONDS)
            return
        frame = frame.f_back
    raise KeyboardInterrupt
