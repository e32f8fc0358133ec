"""The newest value of something that is computed again and again, in a copy of the process."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import closing
from typing import Generic, TypeVar

from harness.core.activity import Activity, unobserved
from harness.core.errors import HarnessError
from harness.session.background import Background

T = TypeVar("T")

LONGEST = 60.0  # [s], that a value is waited for: a copy of a process with threads may hang


class Newest(Generic[T]):
    """Computes one value at a time from the state in which it begins; the caller continues."""

    def __init__(self) -> None:
        self._work: Background[T] | None = None

    @property
    def is_busy(self) -> bool:
        """Whether a value is being computed."""
        return self._work is not None

    def begin(self, function: Callable[[], T]) -> None:
        """Begin to compute a value; an older one that is not known yet is given up."""
        self.cancel()

        def compute(_: Activity) -> T:
            os.nice(5)  # what is shown goes first
            return function()

        self._work = Background(compute, despite_threads=True)

    def taken(self, *, wait: bool = False) -> T | None:
        """The value, once; None while there is none.

        Args:
            wait: Whether to wait for the value that is being computed.

        Raises:
            HarnessError: The process ended without a value, or is given up.
            Exception: What the function raised.
        """
        work, end = self._work, time.monotonic() + LONGEST
        while wait and work is not None and not work.has_message():
            if time.monotonic() > end:
                self.cancel()
                raise HarnessError(f"no answer within {LONGEST:.0f} s")
            time.sleep(0.01)
        if work is None or not work.has_message():
            return None
        self._work = None
        with closing(work):
            return work.result(unobserved)

    def cancel(self) -> None:
        """Give up the value that is being computed."""
        if self._work is not None:
            self._work.close()
            self._work = None
