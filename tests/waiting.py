"""Waiting in tests: for an event, at most as long as only a hang takes."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")

HANG = 3600.0
"""Wall time after which a wait counts as a hang [s].

A test at a low priority got 3 % of a processor at load 18: a command that computes for 20 s then
takes 700 s.
"""

MOST_WORK = 120.0
"""Processor time that no refusal of a file may take [s]; each takes less than one."""


def wait_for(condition: Callable[[], T]) -> T:
    """What a condition returns as soon as that is true."""
    end = time.monotonic() + HANG
    while not (value := condition()):
        assert time.monotonic() < end, f"nothing happened within {HANG:g} s"
        time.sleep(0.01)
    return value


def is_alive(pid: int) -> bool:
    """Whether a process runs; a zombie does not."""
    try:
        return "State:\tZ" not in Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    except (FileNotFoundError, ProcessLookupError):
        return False
