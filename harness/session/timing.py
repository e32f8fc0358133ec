"""Wall time of the parts of a case; reported, never judged."""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import contextmanager


class Clock:
    """Wall seconds by part; a part inside another one counts for itself alone."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def part(self, name: str) -> Generator[None]:
        """Add the time spent inside to a part, without that of parts inside it."""
        begin, before = time.perf_counter(), sum(self.seconds.values())
        try:
            yield
        finally:
            inner = sum(self.seconds.values()) - before
            spent = time.perf_counter() - begin - inner
            self.seconds[name] = self.seconds.get(name, 0.0) + spent
