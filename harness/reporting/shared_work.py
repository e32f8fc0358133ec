"""What cases took from other cases of the same command instead of computing it, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from harness.reporting.result import CaseResult

COUNTED = ("plans", "goals")
"""Kinds of which there are a few; of the others a share is said."""


def shared_words(shared: Mapping[str, tuple[int, int]]) -> str:
    """What one case took: `7 of 7 plans, 90 % of the physics`; empty where it took nothing."""
    order = sorted(shared, key=lambda kind: (kind not in COUNTED, -shared[kind][0], kind))
    return ", ".join(_words(kind, *shared[kind]) for kind in order if shared[kind][0])


def shared_sentence(results: Iterable[CaseResult]) -> str:
    """What the cases of a suite took together; empty where none took anything."""
    taken, all_of, sharing, count = Counter[str](), Counter[str](), 0, 0
    for result in results:
        count += 1
        sharing += any(number for number, _ in result.shared.values())
        for kind, (number, total) in result.shared.items():
            taken[kind] += number
            all_of[kind] += total
    if not sharing:
        return ""
    words = shared_words({kind: (taken[kind], all_of[kind]) for kind in all_of})
    return (
        f"{sharing} of {count} cases took results from others that had the same inputs, instead of"
        f" computing them again: {words}."
    )


def _words(kind: str, taken: int, total: int) -> str:
    if kind in COUNTED:
        return f"{taken} of {total} {kind}"
    return f"{100 * taken // total} % of the {kind}"
