"""Reports work that takes longer than a user expects, while it goes on."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar

from harness.core.printable import printable

PATIENCE = 2.0  # [s], after which work is reported


def _on_stderr(text: str) -> None:
    sys.stderr.write(f"{printable(text)}\n")
    sys.stderr.flush()


_report: ContextVar[Callable[[str], None]] = ContextVar("slow_work", default=_on_stderr)


@contextmanager
def reported_to(report: Callable[[str], None]) -> Generator[None]:
    """Let slow work in this context be reported to a function, in a thread, and not on stderr."""
    token = _report.set(report)
    try:
        yield
    finally:
        _report.reset(token)


@contextmanager
def reported(text: str, *, after: float = PATIENCE) -> Generator[None]:
    """Report a text if what runs inside takes longer than some seconds."""
    timer = threading.Timer(after, _report.get(), (text,))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
