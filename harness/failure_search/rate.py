"""What the low-discrepancy samples of a search show about the share of the ranges that fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.failure_search.evaluator import Sample

CONFIDENCE = 0.95


@dataclass(frozen=True)
class FailureRate:
    """The share of the ranges in which the scenario fails.

    Attributes:
        failed: The number of `total` that failed.
        total: The low-discrepancy samples; samples of the optimiser would count failures twice.
        low: Lower end of the interval of Clopper and Pearson [1].
        high: The upper end; where none failed, the one-sided bound.
        confidence: The confidence of the interval.

    References:
        [1] C. J. Clopper, E. S. Pearson, "The Use of Confidence or Fiducial Limits Illustrated in
            the Case of the Binomial", Biometrika 26(4), 1934.
    """

    failed: int
    total: int
    low: float
    high: float
    confidence: float

    @property
    def sentence(self) -> str:
        """The rate in one sentence."""
        where = f"{self.failed} of {self.total} low-discrepancy samples failed"
        sure = f"with {self.confidence:.0%} confidence"
        if not self.failed:
            return f"{where}: {sure}, at most {self.high:.2%} of the ranges fails"
        share = self.failed / self.total
        return f"{where}: {share:.2%} of the ranges fails, {sure} {self.low:.2%} to {self.high:.2%}"


def failure_rate(start: Sequence[Sample]) -> FailureRate:
    """The rate that the first samples of a search show."""
    from scipy.stats import binomtest

    failed = sum(each.result.outcome != "passed" for each in start)
    test = binomtest(failed, len(start), alternative="two-sided" if failed else "less")
    interval = test.proportion_ci(CONFIDENCE, method="exact")
    return FailureRate(failed, len(start), float(interval.low), float(interval.high), CONFIDENCE)
