"""Splits a text into words with places."""

from __future__ import annotations

import math
import re

from harness.core.errors import SpecError
from harness.language.base import LARGEST_NUMBER
from harness.language.files.source import Place, Source

WORD = re.compile(r"\S+")


class TokenReader:
    """The words of a text, one after the other.

    Attributes:
        last: Place of the last word.
    """

    def __init__(self, text: str, source: Source) -> None:
        self._source = source
        self._lines = source.lines or (text,)
        self._line, self._column = 0, 0
        self.last = Place(source, 1, 1)

    def rest_of_line(self) -> str:
        """The rest of the line; the next word is from the following line."""
        if self._line >= len(self._lines):
            return ""
        rest = self._lines[self._line][self._column :]
        self._line, self._column = self._line + 1, 0
        return rest.strip()

    @property
    def is_at_end(self) -> bool:
        """Whether no word follows."""
        return not any(line.strip() for line in self._lines_left())

    def _lines_left(self) -> tuple[str, ...]:
        rest = self._lines[self._line : self._line + 1]
        return tuple(line[self._column :] for line in rest) + tuple(self._lines[self._line + 1 :])

    def lines_ahead(self) -> tuple[str, ...]:
        """The lines that are not read yet."""
        return self._lines[self._line :]

    def next(self) -> tuple[str, Place]:
        """The next word and its place; empty at the end."""
        while self._line < len(self._lines):
            found = WORD.search(self._lines[self._line], self._column)
            if found:
                self._column = found.end()
                self.last = Place(self._source, self._line + 1, found.start() + 1, len(found[0]))
                return found[0], self.last
            self._line, self._column = self._line + 1, 0
        return "", self.last

    def number(self) -> float:
        """The next word as a number.

        Raises:
            SpecError: It is not a finite number, or beyond `LARGEST_NUMBER`.
        """
        word, place = self.next()
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            found = f"`{word[:40]}`" if word else "the end of the file"
            raise SpecError([place.problem(f"expected a finite number, found {found}")])
        if abs(value) > LARGEST_NUMBER:
            message = f"{value:g} is too large; at most {LARGEST_NUMBER:g}"
            raise SpecError([place.problem(message)])
        return value

    def count(self, what: str, most: int) -> int:
        """The next word as a whole number from 0.

        Args:
            what: The counted things, for messages.
            most: The largest number that is accepted.

        Raises:
            SpecError: It is not a whole number, or larger.
        """
        word, place = self.next()
        if not word.isdecimal():
            found = f"`{word[:40]}`" if word else "the end of the file"
            raise SpecError([place.problem(f"expected a number of {what}, found {found}")])
        if len(word) > 9 or int(word) > most:
            raise SpecError([place.problem(f"{word[:40]} {what}; at most {most} are supported")])
        return int(word)
