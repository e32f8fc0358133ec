"""Which recorded samples go into a bag, and what one message there is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.plugins.ros.bag.topics import Topic

BLOCK = 1024  # samples whose frames are computed at once: it bounds the memory of a long run


@dataclass(frozen=True, eq=False)
class Message:
    """Something published."""

    time: float
    topic: Topic
    content: Any


def samples_at(times: FloatArray, rate: float) -> IntArray:
    """Indices of the samples at a rate [Hz], at most all of them; first and last are among them."""
    last = len(times) - 1
    if (times[-1] - times[0]) * rate >= last:
        return np.arange(last + 1)
    due = times[0] + np.arange(int((times[-1] - times[0]) * rate + 1e-6) + 1) / rate
    found = np.searchsorted(times, np.asarray(due, dtype=np.float64) - 1e-9)
    return np.unique(np.concatenate([np.minimum(found, last), np.array([0, last])]))


def blocks(indices: IntArray) -> Iterator[IntArray]:
    """The indices, some at a time."""
    for start in range(0, len(indices), BLOCK):
        yield indices[start : start + BLOCK]
