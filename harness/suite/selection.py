"""`-k EXPR`: which scenarios an expression of words selects, as in pytest."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from harness.suite.discovery import UsageError
from harness.suite.header import ScenarioHeader

_TOKEN = re.compile(r"[()]|[^\s()]+")
_OPERATORS = frozenset(("(", ")", "and", "or", "not"))


def selects(expression: str, file: Path, header: ScenarioHeader, case: str = "") -> bool:
    """Whether an expression holds for a case of a scenario.

    A word holds if the file's path, the title, a tag or the case's name contains it, in any case;
    `and`, `or`, `not` and brackets as in Python, which reads the expression with a truth value in
    place of each word.

    Raises:
        UsageError: The expression cannot be read.
    """
    text = "\n".join([file.as_posix(), header.title, *header.tags, case]).lower()
    tokens: list[str] = _TOKEN.findall(expression)
    values = [each if each in _OPERATORS else str(each.lower() in text) for each in tokens]
    try:
        return _holds(ast.parse(" ".join(values), mode="eval").body)
    except SyntaxError as error:
        raise UsageError(f"-k '{expression}' cannot be read: {error.msg}") from None
    except (RecursionError, MemoryError):
        raise UsageError("-k: its brackets and `not` are nested too deeply") from None


def _holds(node: ast.AST) -> bool:
    """The truth value of a parsed expression."""
    match node:
        case ast.Constant(value=bool() as value):
            return value
        case ast.UnaryOp(operand=operand):
            return not _holds(operand)
        case ast.BoolOp(op=ast.And(), values=values):
            return all(list(map(_holds, values)))  # each part is looked at: it may be wrong
        case ast.BoolOp(values=values):
            return any(list(map(_holds, values)))
        case _:
            raise SyntaxError("two words stand next to each other")
