"""Success rates of random cases: the interval, and a test that may end the sampling early."""

from __future__ import annotations

import math
from statistics import NormalDist

from harness.reporting.sampled import RateVerdict, SuccessRate


def wilson_interval(passed: int, total: int, confidence: float) -> tuple[float, float]:
    """Two-sided interval of a proportion that stays sensible at 0 and at 1 [1].

    References:
        [1] E. B. Wilson, "Probable Inference, the Law of Succession, and Statistical Inference",
            Journal of the American Statistical Association 22(158), 1927.
    """
    if not total:
        return 0.0, 1.0
    z = NormalDist().inv_cdf(0.5 + confidence / 2)
    share = passed / total
    middle = share + z * z / (2 * total)
    reach = z * math.sqrt(share * (1 - share) / total + z * z / (4 * total * total))
    scale = 1 + z * z / total
    low = 0.0 if passed == 0 else (middle - reach) / scale
    high = 1.0 if passed == total else (middle + reach) / scale
    return low, high


def log_evidence_against(passed: int, total: int, rate: float) -> float:
    """Log of how much likelier the samples are under some other rate, all alike, than under one.

    The mixture likelihood ratio with a uniform prior: under `rate` it exceeds 1 / a at any time
    with a probability of at most a, however often one looks [1].

    References:
        [1] H. Robbins, "Statistical Methods Related to the Law of the Iterated Logarithm",
            Annals of Mathematical Statistics 41(5), 1970.
    """
    failed = total - passed
    mixture = math.lgamma(passed + 1) + math.lgamma(failed + 1) - math.lgamma(total + 2)
    if (rate >= 1.0 and failed) or (rate <= 0.0 and passed):
        return math.inf
    under = (passed * math.log(rate) if passed else 0.0) + (
        failed * math.log1p(-rate) if failed else 0.0
    )
    return mixture - under


def decided(passed: int, total: int, at_least: float, confidence: float) -> RateVerdict:
    """Whether the sequential test has decided, after some samples in their order."""
    if not total or log_evidence_against(passed, total, at_least) < -math.log(1 - confidence):
        return "open"
    return "shown" if passed / total > at_least else "refuted"


class Tally:
    """Samples counted one after the other, in the order of their numbers.

    Attributes:
        passed: The number of `total` that passed.
        total: Samples that count; samples after an early stop do not.
        is_decided: Whether the sequential test has ended the sampling.
    """

    def __init__(self, at_least: float | None, confidence: float, *, stop_early: bool) -> None:
        """Count nothing yet.

        Args:
            at_least: Rate to be shown; None: every one must pass.
            confidence: The confidence of the interval and of the sequential test.
            stop_early: Whether the sequential test may end the sampling.
        """
        self.passed, self.total = 0, 0
        self.is_decided = False
        self._at_least, self._confidence, self._stop_early = at_least, confidence, stop_early
        self._first_digest = ""
        self._are_alike = True

    @property
    def is_one_run(self) -> bool:
        """Whether several samples were one and the same run: nothing that matters varied."""
        return self.total > 1 and self._are_alike

    def add(self, is_good: bool, digest: str) -> None:
        """Count the next sample; equal digests decide nothing, however many there are."""
        if self.is_decided:
            return
        self.passed += is_good
        self.total += 1
        self._first_digest = self._first_digest or digest
        self._are_alike &= bool(digest) and digest == self._first_digest
        if self._at_least is not None and self._stop_early and not self.is_one_run:
            verdict = decided(self.passed, self.total, self._at_least, self._confidence)
            self.is_decided = verdict != "open"

    def rate(self, planned: int, invalid: int = 0) -> SuccessRate:
        """What the samples show; none show nothing.

        Args:
            planned: Number of samples without an early stop.
            invalid: Samples that could not be run, which do not count.
        """
        passed, total, required = self.passed, self.total, self._at_least
        low, high = wilson_interval(passed, total, self._confidence)
        verdict: RateVerdict = "open"
        if not total:
            verdict = "open"
        elif required is None:
            verdict = "shown" if passed == total else "refuted"
        elif self.is_one_run:
            verdict = "open"
        elif self.is_decided:
            verdict = decided(passed, total, required, self._confidence)
        elif low >= required:
            verdict = "shown"
        elif high < required:
            verdict = "refuted"
        early = self.is_decided and total < planned
        return SuccessRate(
            passed,
            total,
            low,
            high,
            self._confidence,
            required,
            verdict,
            early,
            invalid=invalid,
            is_one_run=self.is_one_run,
        )
