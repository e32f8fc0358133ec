"""How many cases a scenario file may have."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

MOST_CASES = 10_000
"""Of a grid, or of named ones."""

MOST_SAMPLES = 100_000
"""Of all cases together."""

Cases = Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]]
"""A grid of values by path, or named cases."""


def count_of(parametrize: Cases | None) -> int:
    """How many cases a file has without its samples."""
    if parametrize is None:
        return 1
    if isinstance(parametrize, Mapping):
        return math.prod(len(values) for values in parametrize.values())
    return len(parametrize)
