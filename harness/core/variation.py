"""Limits on the number of cases of a scenario file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

MOST_CASES = 10_000  # of a grid, or named
MOST_SAMPLES = 100_000  # of all cases together
Parametrize = Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]]  # a grid, or named cases


def count_of(parametrize: Parametrize | None) -> int:
    """Number of cases of a file, without its samples."""
    if parametrize is None:
        return 1
    if isinstance(parametrize, Mapping):
        return math.prod(len(values) for values in parametrize.values())
    return len(parametrize)
