"""Which values a number of a formula can have, and the comparisons that no run decides."""

from __future__ import annotations

import math
from collections.abc import Callable

from harness.plugins.formulas.language.formula import Arithmetic, Comparison, Const, Number, Signal

Range = tuple[float, float]

ANY: Range = (-math.inf, math.inf)
SIGNAL_RANGES: dict[str, Range] = {
    "time": (0.0, math.inf),
    "tilt": (0.0, math.pi),
    "speed": (0.0, math.inf),
    "force": (0.0, math.inf),
}
"""The least and the largest value of signals that are bounded in every run, in SI."""

RangeOf = Callable[[Signal], Range]


def range_of_signal(signal: Signal) -> Range:
    """The least and the largest value of a signal in any run."""
    return SIGNAL_RANGES.get(signal.name, ANY)


def range_of(node: Number, of_signal: RangeOf = range_of_signal) -> Range:
    """The least and the largest value of a number, by interval arithmetic of its signals."""
    match node:
        case Const(value=value):
            return value, value
        case Signal():
            return of_signal(node)
        case Arithmetic(operator="*", operands=(first, second)) if _key(first) == _key(second):
            size = _calculated("abs", [range_of(first, of_signal)])
            return _calculated("*", [size, size])
        case Arithmetic(operator=operator, operands=operands):
            return _calculated(operator, [range_of(each, of_signal) for each in operands])


def _calculated(operator: str, ranges: list[Range]) -> Range:
    (low, high), other = ranges[0], ranges[-1]
    match operator:
        case "neg":
            return -high, -low
        case "abs":
            return 0.0 if low <= 0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high))
        case "min":
            return min(low, other[0]), min(high, other[1])
        case "max":
            return max(low, other[0]), max(high, other[1])
        case "+":
            return low + other[0], high + other[1]
        case "-":
            return low - other[1], high - other[0]
        case "*":
            products = [0.0 if 0 in (a, b) else a * b for a in (low, high) for b in other]
            return min(products), max(products)
        case _:
            if other[0] <= 0 <= other[1]:
                return ANY
            return _calculated("*", [ranges[0], (1 / other[1], 1 / other[0])])


def decided(comparison: Comparison, of_signal: RangeOf = range_of_signal) -> bool | None:
    """Whether a comparison holds in every run, or in none; None where a run decides.

    What both sides have in common is cancelled: `z(box) < z(box) + 1` holds in every run.
    """
    terms = _terms(comparison.left)
    for key, (node, factor) in _terms(comparison.right).items():
        terms[key] = node, terms.get(key, (node, 0.0))[1] - factor
    low = high = 0.0
    for node, factor in terms.values():
        if factor:
            least, most = _calculated("*", [(factor, factor), range_of(node, of_signal)])
            low, high = low + least, high + most
    if comparison.operator.startswith("<"):
        low, high = -high, -low
    if "=" in comparison.operator:
        return True if low >= 0 else False if high < 0 else None
    return True if low > 0 else False if high <= 0 else None


def _terms(node: Number) -> dict[str, tuple[Number, float]]:
    """What a number is the sum of, each with its factor, by a text that is equal for equal ones."""
    if isinstance(node, Arithmetic) and node.operator in ("+", "-", "neg"):
        found: dict[str, tuple[Number, float]] = {}
        signs = {"+": (1.0, 1.0), "-": (1.0, -1.0), "neg": (-1.0,)}[node.operator]
        for operand, sign in zip(node.operands, signs, strict=True):
            for key, (part, factor) in _terms(operand).items():
                found[key] = part, found.get(key, (part, 0.0))[1] + sign * factor
        return found
    return {_key(node): (node, 1.0)}


def _key(node: Number) -> str:
    if isinstance(node, Arithmetic):
        return f"{node.operator}({', '.join(_key(each) for each in node.operands)})"
    return repr(node.value) if isinstance(node, Const) else str(node)
