"""Outcomes of samples, counted."""

from harness.suite.rates import Tally


def rate_of(outcomes, at_least, confidence, *, stop_early):
    """The rate of outcomes in their order."""
    tally = Tally(at_least, confidence, stop_early=stop_early)
    for is_good in outcomes:
        tally.add(is_good)
    return tally.rate(len(outcomes))
