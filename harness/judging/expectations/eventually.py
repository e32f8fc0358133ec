"""eventually: a predicate at some sample."""

from __future__ import annotations

from harness.judging.expectation import TemporalWord


class Eventually(TemporalWord):
    """The predicate holds at some sample of the window; with `for`, for that long."""

    is_change = True
