"""What cases took from other cases of the same command instead of computing it, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from harness.reporting.result import CaseResult

COUNTED = ("plans", "goals", "models")
"""Kinds of results that are counted one by one; of the others a share is shown."""


def shared_words(shared: Mapping[str, tuple[int, int]]) -> str:
    """What one case took: `7 of 7 plans, 90 % of the physics`; empty where it took nothing."""
    order = sorted(shared, key=lambda kind: (kind not in COUNTED, -shared[kind][0], kind))
    return ", ".join(_words(kind, *shared[kind]) for kind in order if shared[kind][0])


@dataclass
class SharedWork:
    """What the cases of a suite took from each other together."""

    cases: int = 0
    sharing: int = 0
    taken: Counter[str] = field(default_factory=Counter[str])
    totals: Counter[str] = field(default_factory=Counter[str])

    def add(self, result: CaseResult) -> None:
        """Count the next case."""
        self.cases += 1
        self.sharing += any(number for number, _ in result.shared.values())
        for kind, (number, total) in result.shared.items():
            self.taken[kind] += number
            self.totals[kind] += total

    def sentence(self) -> str:
        """All of it in a sentence; empty where no case took anything."""
        if not self.sharing:
            return ""
        words = shared_words({kind: (self.taken[kind], self.totals[kind]) for kind in self.totals})
        return (
            f"{self.sharing} of {self.cases} cases took results from others that had the same"
            f" inputs, instead of computing them again: {words}."
        )


def _words(kind: str, taken: int, total: int) -> str:
    if kind in COUNTED:
        return f"{taken} of {total} {kind}"
    return f"{100 * taken // total} % of the {kind}"
