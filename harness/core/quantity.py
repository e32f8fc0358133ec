"""Numbers as files write them: `10 cm`, `90 %`, `pi/2`; and digits that show a difference."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable

QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
CONSTANTS = {"pi": math.pi, "π": math.pi, "tau": math.tau}
EXPRESSION = re.compile(r"(?:pi|π|tau|[\d.eE+\-*/() ])+")
IMPLIED_PRODUCT = re.compile(r"(\d|\))\s*(?=pi|π|tau|\()")
LONGEST_EXPRESSION = 60  # characters
OPERATORS: dict[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: lambda left, right: left + right,
    ast.Sub: lambda left, right: left - right,
    ast.Mult: lambda left, right: left * right,
    ast.Div: lambda left, right: left / right,
}


def split_quantity(value: object) -> tuple[float, str]:
    """The number and the text of its unit, which is empty without a unit.

    Raises:
        ValueError: It is neither a number nor one with a unit.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return float(value), ""
        except OverflowError as error:
            raise ValueError("the number has more than 308 digits") from error
    constant = constant_of(value) if isinstance(value, str) else None
    if constant is not None:
        return constant, ""
    found = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        raise ValueError(f"`{value}` is not a number, alone or with a unit")
    return float(found[1]), found[2]


def common_unit(*values: object) -> str:
    """The unit of several quantities, empty without one; a 0 needs none.

    Raises:
        ValueError: They have different units.
    """
    found = {unit for number, unit in map(split_quantity, values) if unit or number}
    if len(found) > 1:
        written = ", ".join(f"`{value}`" for value in values)
        raise ValueError(f"{written} must be in one unit")
    return found.pop() if found else ""


MOST_DIGITS = 17  # after which different floating-point numbers are written differently


def distinct(first: float, second: float, text: Callable[[float, int], str]) -> tuple[str, str]:
    """The texts of two numbers, with as many more digits as needed to distinguish them.

    Args:
        text: Formats a number with the given number of additional digits.
    """
    pairs = ((text(first, more), text(second, more)) for more in range(MOST_DIGITS + 1))
    usual = next(pairs)
    if usual[0] != usual[1] or first == second:
        return usual
    return next((pair for pair in pairs if pair[0] != pair[1]), usual)


def constant_of(text: str) -> float | None:
    """The value of a constant expression such as `-pi/2` or `3*(pi - 1)`; None for other text.

    An expression consists of numbers, pi, tau, the four operations and parentheses. It has at least
    one constant or operation: a number in quotes is text.
    """
    if len(text) > LONGEST_EXPRESSION or EXPRESSION.fullmatch(text) is None:
        return None
    try:
        tree = ast.parse(IMPLIED_PRODUCT.sub(r"\1*", text.strip()), mode="eval").body
        is_number = isinstance(tree, ast.Constant) or (
            isinstance(tree, ast.UnaryOp) and isinstance(tree.operand, ast.Constant)
        )
        value = None if is_number else _value(tree)
    except (SyntaxError, ValueError, ArithmeticError, RecursionError, MemoryError):
        return None
    return value if value is not None and math.isfinite(value) else None


def _value(node: ast.AST) -> float:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id=name) if name in CONSTANTS:
            return CONSTANTS[name]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _value(operand)
        case ast.BinOp(left=left, op=operation, right=right) if type(operation) in OPERATORS:
            return OPERATORS[type(operation)](_value(left), _value(right))
        case _:
            raise ValueError("no constant expression")
