"""never: a predicate at no sample."""

from __future__ import annotations

from harness.judging.expectation import TemporalWord


class Never(TemporalWord):
    """The predicate holds at no sample of the window."""
