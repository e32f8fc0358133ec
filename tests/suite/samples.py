"""Outcomes of samples, counted."""

from harness.suite.sampling import Tally


def rate_of(outcomes, at_least, confidence, *, stop_early, digests=None):
    """The rate of outcomes in their order; by default each is a run of its own."""
    tally = Tally(at_least, confidence, stop_early=stop_early)
    for index, is_good in enumerate(outcomes):
        tally.add(is_good, f"run {index}" if digests is None else digests[index])
    return tally.rate(len(outcomes))
