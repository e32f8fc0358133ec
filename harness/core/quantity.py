"""A number with a unit as files write it: `10 cm`; and digits that tell two numbers apart."""

from __future__ import annotations

import re
from collections.abc import Callable

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


MOST_DIGITS = 17
"""Digits after which two different floating-point numbers are written differently."""


def distinct(first: float, second: float, text: Callable[[float, int], str]) -> tuple[str, str]:
    """The texts of two numbers, with as many more digits as it takes to tell them apart.

    Args:
        first: A number.
        second: Another; equal numbers have equal texts.
        text: Writes a number with so many more digits than usual.
    """
    pairs = ((text(first, more), text(second, more)) for more in range(MOST_DIGITS + 1))
    usual = next(pairs)
    if usual[0] != usual[1] or first == second:
        return usual
    return next((pair for pair in pairs if pair[0] != pair[1]), usual)
