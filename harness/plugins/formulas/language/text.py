"""The words, numbers and signs of a formula, each with its place in the text."""

from __future__ import annotations

import re
from dataclasses import dataclass

from harness.language.files.mistakes import MistakeError

TOKEN = re.compile(
    r"""\s*(?:
    (?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<quoted>"[^"]*"|'[^']*')
  | (?P<symbol><=|>=|->|&&|\|\||[-+*/<>()\[\],!&|])
  | (?P<end>\Z)
    )""",
    re.VERBOSE,
)
ALIASES = {
    **{"G": "always", "F": "eventually", "U": "until", "->": "implies"},
    **{"|": "or", "||": "or", "&": "and", "&&": "and", "!": "not"},
}
OTHER_SIGNS = {
    **{"=>": "write `>=`", "≥": "write `>=`", "=<": "write `<=`", "≤": "write `<=`"},
    **dict.fromkeys(("==", "="), "write `>=` or `<=`: two numbers are hardly ever equal"),
}
"""Signs of other languages, the longest first, and what a formula has instead."""
WORDS = ("always", "eventually", "until", "not", "and", "or", "implies")


class FormulaError(MistakeError):
    """A formula that cannot be read.

    Attributes:
        span: First of the offending characters, from 0, and how many there are.
    """

    def __init__(self, start: int, length: int, message: str, hint: str = "") -> None:
        super().__init__(message, hint, (start, max(1, length)))


@dataclass(frozen=True)
class Token:
    """A word, number or sign; `kind` is number, name, quoted, symbol, word or end."""

    kind: str
    text: str
    start: int
    source: str


def tokens_of(text: str) -> list[Token]:
    """Every token of a text; the last one is its end.

    Raises:
        FormulaError: A character has no meaning in a formula.
    """
    tokens: list[Token] = []
    place = 0
    while not tokens or tokens[-1].kind != "end":
        match = TOKEN.match(text, place)
        if match is None:
            start = place + len(text[place:]) - len(text[place:].lstrip())
            sign = next((each for each in OTHER_SIGNS if text.startswith(each, start)), text[start])
            hint = OTHER_SIGNS.get(sign, 'names with other characters stand in quotes: z("my box")')
            message = f"`{sign}` has no meaning in a formula"
            raise FormulaError(start, len(sign), message, hint)
        kind = match.lastgroup or "end"
        source = match[kind]
        word = ALIASES.get(source, source)
        is_word = kind in ("name", "symbol") and word in WORDS
        tokens.append(Token("word" if is_word else kind, word, match.start(kind), source))
        place = match.end()
    return tokens
