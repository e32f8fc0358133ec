"""The interval of a proportion."""

from __future__ import annotations

import math
from statistics import NormalDist


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
