"""Contacts that are about to begin where bodies are put."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from harness.core.types import BoolArray
from harness.judging.contacts import DEBOUNCE
from harness.judging.poses import arrivals
from harness.judging.temporal import last_within
from harness.recording.run import Run


def settled(run: Run, holds: BoolArray, names: Collection[str]) -> BoolArray:
    """Samples that count of a contact between bodies: not those in which it is about to begin.

    Bodies that are put where they touch exactly press each other some milliseconds later.
    """
    counts, last = np.ones(len(holds), dtype=bool), last_within(run.signals.times, DEBOUNCE)
    for name in {each.name for each in run.objects} & {*names}:
        for start in (0, *arrivals(run, name)):
            counts[start : start + int(holds[start : last[start] + 1].argmax())] = False
    return counts
