"""What a later reader of a case's result needs besides its outcome, as names and values."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.recording.verdict import Verdict
from harness.reporting.margins import margin_share, worst
from harness.reporting.suite.record import SuiteCase


def case_properties(case: SuiteCase) -> list[tuple[str, str]]:
    """Name and value of everything that a later reader needs besides the outcome."""
    result = case.result
    found = [("seed", str(result.seed)), ("digest", result.digest)]
    found.append(("simulated", f"{result.sim_time:.3f} s"))
    found += [("verifies", each) for each in case.verifies]
    found += [(f"value:{path}", str(value)) for path, value in case.values.items()]
    found += [
        (f"margin:{verdict.expectation}", _margin(verdict))
        for verdict in result.verdicts
        if not math.isnan(verdict.margin)
    ]
    if case.nearest is not None:
        found.append(("worst_margin", case.nearest.expectation))
    return found


def sample_properties(cases: Sequence[SuiteCase]) -> list[tuple[str, str]]:
    """Properties of samples together: seed and digest of each, the smallest margins by sample."""
    found = [("verifies", each) for case in cases[:1] for each in case.verifies]
    found += [(f"seed:{case.result.case}", str(case.result.seed)) for case in cases]
    found += [(f"digest:{case.result.case}", case.result.digest) for case in cases]
    least: dict[str, tuple[Verdict, str]] = {}
    for case in cases:
        for verdict in case.result.verdicts:
            if math.isnan(verdict.margin):
                continue
            known = least.setdefault(verdict.expectation, (verdict, case.result.case))
            if margin_share(verdict) < margin_share(known[0]):
                least[verdict.expectation] = (verdict, case.result.case)
    found += [(f"margin:{name}", f"{_margin(each)} ({c})") for name, (each, c) in least.items()]
    nearest = worst([verdict for verdict, _ in least.values()])
    if nearest is not None:
        found.append(("worst_margin", nearest.expectation))
    return found


def _margin(verdict: Verdict) -> str:
    return f"{verdict.margin:.6g} {verdict.unit}".removesuffix(" 1")
