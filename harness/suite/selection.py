"""`-k EXPR`: which scenarios an expression of words selects, as in pytest."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from harness.suite.discovery import UsageError
from harness.suite.header import ScenarioHeader

_TOKEN = re.compile(r"\s*(?:([()])|([^\s()]+))")
_Part = Callable[[str], bool]


def selects(expression: str, file: Path, header: ScenarioHeader, case: str = "") -> bool:
    """Whether an expression holds for a case of a scenario.

    A word holds if the file's path, the title, a tag or the case's name contains it, in any case;
    `and`, `or`, `not` and brackets as in Python.

    Raises:
        UsageError: The expression cannot be read.
    """
    text = "\n".join([file.as_posix(), header.title, *header.tags, case]).lower()
    parser = _Parser(expression)
    try:
        value = parser.any_of(text)
    except RecursionError:
        raise UsageError("-k: its brackets and `not` are nested too deeply") from None
    if parser.tokens:
        raise UsageError(f"-k '{expression}': cannot read it from '{parser.tokens[0]}' on")
    return value


class _Parser:
    """Recursive descent without short-circuits, so that every mistake is found."""

    def __init__(self, expression: str) -> None:
        self.expression = expression
        self.tokens = ["".join(pair) for pair in _TOKEN.findall(expression)]

    def any_of(self, text: str) -> bool:
        return any(self._joined("or", self._all_of, text))

    def _all_of(self, text: str) -> bool:
        return all(self._joined("and", self._one, text))

    def _joined(self, word: str, part: _Part, text: str) -> Sequence[bool]:
        values = [part(text)]
        while self.tokens[:1] == [word]:
            self.tokens.pop(0)
            values.append(part(text))
        return values

    def _one(self, text: str) -> bool:
        token = self.tokens.pop(0) if self.tokens else ""
        if token == "not":
            return not self._one(text)
        if token == "(":
            value = self.any_of(text)
            if not self.tokens or self.tokens.pop(0) != ")":
                raise UsageError(f"-k '{self.expression}': a bracket is not closed")
            return value
        if token in {"", ")", "and", "or"}:
            raise UsageError(f"-k '{self.expression}': a word is missing before '{token}'")
        return token.lower() in text
