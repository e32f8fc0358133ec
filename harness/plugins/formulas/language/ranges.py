"""Which values a number of a formula can have, and the comparisons that no run decides."""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Callable, Iterator
from typing import Any

from harness.plugins.formulas.language.formula import (
    Arithmetic,
    Comparison,
    Const,
    Logic,
    Node,
    Number,
    Signal,
    Temporal,
)

Range = tuple[float, float]
Terms = dict[str, tuple[Number, float]]  # of a sum, with their factors; that of "" is the number 1

ONE = Const(1.0, "", 0)
OPERATIONS: dict[str, Callable[..., Any]] = {
    **{"neg": operator.neg, "abs": abs, "min": min, "max": max},
    **{"+": operator.add, "-": operator.sub, "*": operator.mul},
}
SIGNS = {"+": (1.0, 1.0), "-": (1.0, -1.0), "neg": (-1.0,)}
JOINED: dict[str, Callable[[bool, bool], bool]] = {
    "not": lambda first, _: not first,
    "and": operator.and_,
    "or": operator.or_,
    "implies": operator.le,
}
MOST_CASES = 2000  # of a formula; one with more is left to the run

ANY: Range = (-math.inf, math.inf)
SIGNAL_RANGES: dict[str, Range] = {
    "time": (0.0, math.inf),
    "tilt": (0.0, math.pi),
    "speed": (0.0, 1e5),
    "force": (0.0, 1e8),
    **dict.fromkeys("xyz", (-1e7, 1e7)),
    **dict.fromkeys(("surface_velocity", "surface_rotation"), (-1e5, 1e5)),
}
"""The least and the largest value of signals in any run, in SI: free fall for the longest run of
600 s ends 1800 km below, with 6 km/s."""

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
        case Arithmetic(operator=sign, operands=operands):
            return _calculated(sign, [range_of(each, of_signal) for each in operands])


def _calculated(sign: str, ranges: list[Range]) -> Range:
    if sign == "/":
        low, high = ranges[1]
        return ANY if low <= 0 <= high else _calculated("*", [ranges[0], (1 / high, 1 / low)])
    found = [OPERATIONS[sign](*ends) for ends in itertools.product(*ranges)]
    if sign == "abs" and ranges[0][0] < 0 < ranges[0][1]:
        found.append(0.0)
    found = [0.0 if math.isnan(each) else each for each in found]  # 0 times infinity
    return min(found), max(found)


def decided_parts(
    node: Node, of_signal: RangeOf = range_of_signal
) -> list[tuple[Comparison | Logic, bool]]:
    """The smallest parts of a formula that hold in every run, or in none, and which of the two."""
    inner = () if isinstance(node, Comparison) else node.operands
    found = [part for each in inner for part in decided_parts(each, of_signal)]
    if found or isinstance(node, Temporal):
        return found
    cases = list(itertools.islice(_cases(node, of_signal), MOST_CASES))
    is_decided = len(set(cases)) == 1 and len(cases) < MOST_CASES
    return [(node, cases[0])] if is_decided else []


def _cases(root: Comparison | Logic, of_signal: RangeOf) -> Iterator[bool]:
    """Whether a formula holds, for each choice of what its comparisons depend on.

    A sum of signals takes the numbers it is compared with, and some on either side. What is said of
    another sum, or by a temporal word, is taken for independent of it: that adds choices, and
    leaves out none.
    """
    limits: dict[Node, tuple[str, float, float]] = {}  # the sum's text, its factor, the limit
    choices: dict[str | Node, list[float]] = {}
    for part in _joined(root):
        if not isinstance(part, Comparison):
            choices[part] = [0.0, 1.0]
            continue
        # what both sides have in common is cancelled: `z(box) < z(box) + 1`
        terms = _terms(Arithmetic("-", (part.left, part.right), part.start))
        _, number = terms.pop("", (ONE, 0.0))
        by = next((factor for _, (_, factor) in sorted(terms.items()) if factor), 1.0)
        factors = {key: factor / by for key, (_, factor) in sorted(terms.items()) if factor}
        low = high = 0.0
        for key, factor in factors.items():
            ends = _calculated("*", [(factor, factor), range_of(terms[key][0], of_signal)])
            low, high = low + ends[0], high + ends[1]
        text, limit = str(factors), -number / by
        limits[part] = text, by, limit
        below, above = limit - 1 - abs(limit), limit + 1 + abs(limit)
        near = (max(low, below), limit, min(high, above))
        possible = {each for each in near if low <= each <= high}
        choices[text] = sorted(possible.union(choices.get(text, ())))
    for text in {text for text, _, _ in limits.values()}:
        choices[text] += [sum(pair) / 2 for pair in itertools.pairwise(choices[text])]

    def holds(node: Node) -> bool:
        if isinstance(node, Logic):
            return JOINED[node.operator](holds(node.operands[0]), holds(node.operands[-1]))
        if not isinstance(node, Comparison):
            return bool(chosen[node])
        text, by, limit = limits[node]
        value = by * (chosen[text] - limit)
        return "=" in node.operator if value == 0 else (value > 0) == (node.operator[0] == ">")

    for values in itertools.product(*choices.values()):
        chosen = dict(zip(choices, values, strict=True))
        yield holds(root)


def _joined(node: Node) -> list[Node]:
    """The comparisons, and the formulas with temporal words, that `and`, `or`, ... join."""
    if not isinstance(node, Logic):
        return [node]
    return [found for each in node.operands for found in _joined(each)]


def _terms(node: Number) -> Terms:
    """What a number is the sum of, each with its factor, by a text that is equal for equal ones."""
    if isinstance(node, Const):
        return {"": (ONE, node.value)}
    if isinstance(node, Arithmetic) and node.operator in SIGNS:
        found: Terms = {}
        for operand, sign in zip(node.operands, SIGNS[node.operator], strict=True):
            for key, (part, factor) in _terms(operand).items():
                found[key] = part, found.get(key, (part, 0.0))[1] + sign * factor
        return found
    if isinstance(node, Arithmetic) and node.operator in ("*", "/"):
        first, second = map(_terms, node.operands)
        if node.operator == "*" and first.keys() == {""}:
            first, second = second, first
        number = second[""][1] if second.keys() == {""} else 0.0
        if number:
            number = number if node.operator == "*" else 1 / number
            return {key: (part, number * factor) for key, (part, factor) in first.items()}
    return {_key(node): (node, 1.0)}


def _key(node: Number) -> str:
    if isinstance(node, Arithmetic):
        return f"{node.operator}({', '.join(_key(each) for each in node.operands)})"
    return repr(node.value) if isinstance(node, Const) else str(node)
