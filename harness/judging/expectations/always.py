"""always: a predicate at every sample."""

from __future__ import annotations

from harness.judging.expectation import TemporalWord


class Always(TemporalWord):
    """The predicate holds at every sample of the window."""
