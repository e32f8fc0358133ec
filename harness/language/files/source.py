"""A file's values, each with its place, and the way from a model's field back to it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from harness.core.errors import Problem

Loc = tuple[str | int, ...]  # a path of keys and list indices, as pydantic's `loc`

Scalar = str | int | float | bool | None
Plain = Scalar | list["Plain"] | dict[str, "Plain"]

MOST_BEFORE_TEXT = 4  # characters that may stand before a text: a quote, or `>-` with a number
LINE_BREAK = re.compile("\r\n|[\r\n\x85\u2028\u2029]")  # the breaks that YAML's reader counts


@dataclass(frozen=True)
class Source:
    """A text that values come from: a file, or an option of the command line.

    Attributes:
        path: The path as the user named it.
        lines: Its lines; empty for an option, whose problems have no line.
        others: File and line of each of the last lines, where these are of other files.
    """

    path: str
    lines: tuple[str, ...] = ()
    others: tuple[tuple[str, int], ...] = ()

    @classmethod
    def of_text(cls, path: str, text: str) -> Source:
        return cls(path, tuple(LINE_BREAK.split(text)))

    def own_lines(self) -> tuple[str, ...]:
        return self.lines[: len(self.lines) - len(self.others)]

    def origin(self, number: int) -> tuple[str, int]:
        """The file and the line of a line by its number from 1."""
        index = number - 1 - len(self.own_lines())
        is_other = number > 0 and 0 <= index < len(self.others)
        return self.others[index] if is_other else (self.path, number)

    def line(self, number: int) -> str:
        """A line's text by its number from 1; empty where there is none."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def end_of(self, before: str) -> Place:
        """The place after the first characters of the text."""
        lines = LINE_BREAK.split(before)
        return Place(self, len(lines), len(lines[-1]) + 1)


@dataclass(frozen=True)
class Place:
    """Where something is written: line and column from 1 (0: no line), characters to underline."""

    source: Source
    line: int = 0
    column: int = 0
    length: int = 1

    def problem(self, message: str, hint: str = "") -> Problem:
        """A mistake at this place, with its source line."""
        text = self.source.line(self.line)
        length = max(1, min(self.length, len(text) - self.column + 1))
        path, line = self.source.origin(self.line)
        return Problem(path, line, self.column, message, hint, text, length)

    def part(self, text: str, start: int, length: int) -> Place:
        """The place of some characters of a text that is written here, in quotes or over lines.

        Characters are found by what is not blank, since folding changes only blanks; where escapes
        change more, the whole text is the place.
        """
        written = [
            (number, column, character)
            for number in range(self.line, self.line + text.count("\n") + len(text) + 3)
            for column, character in enumerate(self.source.line(number), 1)
            if not character.isspace() and (number, column) >= (self.line, self.column)
        ]
        printed = [character for character in text if not character.isspace()]
        before = sum(not character.isspace() for character in text[:start])
        for first in range(MOST_BEFORE_TEXT):
            if [character for *_, character in written[first : first + len(printed)]] == printed:
                if not printed:
                    break
                line, column, _ = written[first + min(before, len(printed) - 1)]
                return Place(self.source, line, column + (before == len(printed)), length)
        return self


class Entry(NamedTuple):
    """One key of a mapping: where the key stands, and its value."""

    key: Place
    value: Located


@dataclass
class Located:
    """A value with its place.

    Attributes:
        value: A scalar, a list, or a mapping by key.
        place: Where it begins; of a step or predicate: its verb.
        tag: The verb or predicate, where a shape of the file was brought into a model's.
    """

    value: Scalar | list[Located] | dict[str, Entry]
    place: Place
    tag: str = ""

    def plain(self) -> Plain:
        """The value as plain data, without places."""
        if isinstance(self.value, dict):
            return {key: entry.value.plain() for key, entry in self.value.items()}
        if isinstance(self.value, list):
            return [item.plain() for item in self.value]
        return self.value

    def moved(self, place: Place) -> Located:
        """A copy that stands, with all its parts, at another place."""
        if isinstance(self.value, dict):
            entries = {
                key: Entry(place, item.moved(place)) for key, (_, item) in self.value.items()
            }
            return Located(entries, place, self.tag)
        if isinstance(self.value, list):
            return Located([item.moved(place) for item in self.value], place, self.tag)
        return Located(self.value, place, self.tag)

    def mapping(self) -> dict[str, Entry]:
        """The entries of a mapping; of anything else none."""
        return self.value if isinstance(self.value, dict) else {}

    def items(self) -> list[Located]:
        """The items of a list; of anything else none."""
        return self.value if isinstance(self.value, list) else []


def located(value: Plain, place: Place) -> Located:
    """Plain data, all of it standing at one place."""
    if isinstance(value, dict):
        return Located({k: Entry(place, located(v, place)) for k, v in value.items()}, place)
    if isinstance(value, list):
        return Located([located(item, place) for item in value], place)
    return Located(value, place)


class Found(NamedTuple):
    """The result of following a path.

    Attributes:
        item: The deepest value on the way.
        key: Where its key stands, if it is a mapping's value.
        path: The part of the path that exists in the file.
        is_whole: Whether that is all of the path, tags aside.
    """

    item: Located
    key: Place | None
    path: Loc
    is_whole: bool


@dataclass(frozen=True)
class SourceMap:
    """Maps paths in the model to places in the file."""

    root: Located = field(repr=False)

    def find(self, loc: Loc) -> Found:
        """Follow a path as far as the file goes.

        Args:
            loc: Keys and indices of the model; what the file does not have (a default, the name
                of a union's branch) is stepped over.
        """
        item, key, path, is_whole = self.root, None, list[str | int](), True
        rest = list(loc)
        while rest:
            part = rest.pop(0)
            if isinstance(item.value, dict) and part in item.value:
                key, item = item.value[str(part)]
            elif isinstance(item.value, list) and _is_index(part, item.value):
                key, item = None, item.value[int(part)]
            else:
                is_whole = is_whole and part in ("[key]", item.tag)
                continue
            path.append(part)
        return Found(item, key, tuple(path), is_whole)

    def line_of(self, loc: Loc) -> tuple[int, int]:
        """Line and column, from 1, of a field of the model; of a step: of its verb.

        Of what another file says: of the step that includes it, or 0.
        """
        main = self.root.place.source
        place = next(
            place
            for length in range(len(loc), -1, -1)
            if (place := self.find(loc[:length]).item.place).source is main or not length
        )
        path, line = main.origin(place.line)
        return (line, place.column) if path == main.path else (0, 0)

    def problem(self, loc: Loc, message: str, hint: str = "") -> Problem:
        """A mistake at a field's value."""
        return self.find(loc).item.place.problem(message, hint)

    def problem_in_text(
        self, loc: Loc, start: int, length: int, message: str, hint: str = ""
    ) -> Problem:
        """A mistake in some characters of a field's text, the first of them `start`, from 0."""
        item = self.find(loc).item
        return item.place.part(str(item.plain()), start, length).problem(message, hint)

    def problem_at_key(self, loc: Loc, message: str, hint: str = "") -> Problem:
        """A mistake at a field's key, or at its value where it has none."""
        found = self.find(loc)
        return (found.key or found.item.place).problem(message, hint)


def walk(item: Located, path: Loc = ()) -> Iterator[tuple[Loc, Located]]:
    """Every value of a tree with its path, parents first."""
    yield path, item
    for key, entry in item.mapping().items():
        yield from walk(entry.value, (*path, key))
    for index, child in enumerate(item.items()):
        yield from walk(child, (*path, index))


def _is_index(part: str | int, items: list[Located]) -> bool:
    return isinstance(part, int) and 0 <= part < len(items)
