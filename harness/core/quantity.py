"""A number with a unit as files write it: `10 cm`."""

from __future__ import annotations

import re

QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")


def split_quantity(value: object) -> tuple[float, str]:
    """The number and the text of its unit, empty where there is none.

    Raises:
        ValueError: It is neither a number nor one with a unit.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value), ""
    found = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        raise ValueError(f"`{value}` is not a number, alone or with a unit")
    return float(found[1]), found[2]
