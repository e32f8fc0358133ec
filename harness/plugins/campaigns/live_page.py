"""The page of a suite while it runs: written again and again, and reloaded by the browser."""

from __future__ import annotations

import time
from array import array
from collections.abc import Callable
from pathlib import Path

from harness.cli.work_bar import remaining
from harness.core.lazy import LazySequence
from harness.suite.suite_run import SuiteRun

SHORTEST = 2.0  # wall seconds between two pages, at least
SHARE = 20  # how many times as long as a page takes to write, the next one waits at least


class LivePage:
    """Writes the page of the results that there are, as often as 5 % of the time allow."""

    def __init__(
        self, suite: SuiteRun, folder: Path, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Write nothing yet.

        Args:
            clock: Wall time [s]; it decides when a page is written, and nothing else.
        """
        from harness.reporting.suite.columns import Columns
        from harness.reporting.suite.page import MOST_ROWS

        self._suite = suite
        self._folder = folder
        self._clock = clock
        self._columns = Columns(most_listed=MOST_ROWS)
        self._arrived = array("Q")
        self._begin = self._next = clock()
        self._known = 0

    def result(self, index: int) -> None:
        """Add a result of the suite."""
        if not self._arrived:
            known = [each for each in self._suite.results if each != index]
            self._known = len(known)
            for each in known:
                self._add(each)
        self._add(index)
        now = self._clock()
        if now >= self._next:
            self._write(now)
            end = self._clock()
            self._next = end + max(SHORTEST, SHARE * (end - now))

    def _add(self, index: int) -> None:
        self._arrived.append(index)
        self._columns.add(self._suite.case(index))

    def _write(self, now: float) -> None:
        from harness.reporting.suite.record import SuiteRecord
        from harness.reporting.suite.write import write_suite_page

        done, total = len(self._arrived), len(self._suite.jobs)
        new, known = done - self._known, self._known
        left = remaining(self._begin, now, now, new, total - known)
        record = SuiteRecord(
            "passed" if done == self._columns.outcomes["passed"] else "failed",
            LazySequence(done, lambda place: self._suite.case(self._arrived[place])),
            self._suite.rates,
            progress=f"{done} of {total} runs done{left}",
        )
        write_suite_page(self._folder, record, self._columns)
