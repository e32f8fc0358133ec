"""Success rates of random cases: the interval, and a test that may end the sampling early."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist

from harness.reporting.sampled import Rate, RateVerdict


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


def rate_of(
    outcomes: Sequence[bool],
    at_least: float | None,
    confidence: float,
    *,
    stop_early: bool,
    wanted: int | None = None,
) -> Rate:
    """What samples in their order show; those behind an early end do not count.

    Args:
        outcomes: Whether each sample passed, in the order of their numbers.
        at_least: Rate to be shown; None: every one must pass.
        confidence: Of the interval and of the sequential test.
        stop_early: Whether the sequential test may end the sampling.
        wanted: How many samples there would be without it; None: as many as there are.
    """
    wanted = len(outcomes) if wanted is None else wanted
    passed = 0
    for index, is_good in enumerate(outcomes):
        passed += is_good
        if at_least is not None and stop_early:
            verdict = decided(passed, index + 1, at_least, confidence)
            if verdict != "open":
                low, high = wilson_interval(passed, index + 1, confidence)
                early = index + 1 < wanted
                return Rate(passed, index + 1, low, high, confidence, at_least, verdict, early)
    total = len(outcomes)
    low, high = wilson_interval(passed, total, confidence)
    if at_least is None:
        verdict = "shown" if passed == total else "refuted"
    elif low >= at_least:
        verdict = "shown"
    else:
        verdict = "refuted" if high < at_least else "open"
    return Rate(passed, total, low, high, confidence, at_least, verdict)
