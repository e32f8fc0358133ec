"""How near a run is to failing, and what kind of failure a failed run is."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence

from harness.reporting.result import CaseResult
from harness.reporting.suite.cause import cause_of

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")

UNKNOWN = 1e6  # closeness of a run that says nothing about the expectations that are searched
LEAST_SPREAD = 1e-12  # margins that vary less than this do not depend on what varies
Expectation = tuple[int, int]  # its line in the file, its number among the verdicts


def failure_text(result: CaseResult) -> str:
    """What failed at its root, with its line; empty if nothing."""
    cause = cause_of(result)
    if cause is None:
        return ""
    return f"{cause.group} (line {cause.line})" if cause.line else cause.group


def failure_kind(result: CaseResult) -> str:
    """What failed at its root, to compare runs: without numbers, which may vary; empty if nothing.

    Runs with the same kind failed in the same step with the same code, or in the same expectation.
    """
    cause = cause_of(result)
    return f"{NUMBER.sub('#', cause.group)} at {cause.line}" if cause else ""


def margins(result: CaseResult, name: str | None = None) -> dict[Expectation, float]:
    """The margin of every expectation that has one, in its own unit; negative where it failed.

    Args:
        name: The name of the only expectation that counts; None: all count.
    """
    return {
        (verdict.line, index): verdict.margin
        for index, verdict in enumerate(result.verdicts)
        if not math.isnan(verdict.margin)
        and (name is None or verdict.expectation.startswith(f"{name} ("))
    }


class Closeness:
    """Compares margins of different units: each as a multiple of how much it varies.

    A margin that is always small and never changes cannot be made to fail, and does not hide the
    others.
    """

    def __init__(self, results: Sequence[CaseResult], name: str | None = None) -> None:
        """Measure how much each margin varies over some runs.

        Args:
            name: The name of the only expectation that counts; None: all count.
        """
        found: dict[Expectation, list[float]] = {}
        for result in results:
            for expectation, margin in margins(result, name).items():
                if math.isfinite(margin):
                    found.setdefault(expectation, []).append(margin)
        self._spreads: Mapping[Expectation, float] = {
            expectation: spread
            for expectation, values in found.items()
            if (spread := max(values) - min(values)) > LEAST_SPREAD
        }

    def searched(self, failed: Collection[Expectation]) -> frozenset[Expectation]:
        """The expectations whose margins vary and that have not failed yet."""
        return frozenset(self._spreads) - frozenset(failed)

    def of(self, result: CaseResult, searched: Collection[Expectation]) -> float:
        """The smallest margin among the searched expectations; smaller is nearer to failing."""
        nearest = [
            margin / self._spreads[expectation]
            for expectation, margin in margins(result).items()
            if expectation in searched and not math.isnan(margin)
        ]
        return min(nearest, default=UNKNOWN)


def failed_expectations(result: CaseResult) -> frozenset[Expectation]:
    """The expectations that failed in a run."""
    return frozenset(
        (verdict.line, index)
        for index, verdict in enumerate(result.verdicts)
        if verdict.status != "passed"
    )
