"""Reads a YAML file into values with places: YAML 1.2 scalars, bounded, without tags.

libyaml's events are composed here and not by its own composer: that one calls itself for every
level and ends the process on a file of brackets, resolves scalars by YAML 1.1 (`on` is true,
`1e-3` is text), and drops duplicate keys.
"""

from __future__ import annotations

import math
import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from harness.core.errors import Problem, SpecError
from harness.spec.source import Entry, Located, Place, Scalar, Source

LARGEST_FILE = 2_000_000  # [bytes]
LARGEST_TREE = 100_000  # values, aliases expanded
DEEPEST = 50
LONGEST_NUMBER = 300  # characters

INTEGER = re.compile(r"[-+]?[0-9]+")
BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
CONSTANTS: dict[str, Scalar] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

PLAINER = (
    ("mapping values are not allowed", "a second `:` here; quote text that contains `: `"),
    ("found undefined alias", "no anchor has this name; text that begins with `*` needs quotes"),
    ("found unexpected end of stream", "the text that begins here is not closed"),
    ("did not find expected ',' or ']'", "this list is not closed, or a comma is missing"),
    ("did not find expected ',' or '}'", "this mapping is not closed, or a comma is missing"),
    ("did not find expected node content", "a value is missing, or a bracket is not closed"),
    ("did not find expected '-' indicator", "every item of this list begins with `- `"),
    ("did not find expected key", "this line does not fit the indentation above it"),
    ("could not find expected ':'", "a key ends with `: `"),
)
"""What libyaml says -> what a person would say."""


def read_text(path: Path, shown: str | None = None) -> str:
    """The text of a file.

    Raises:
        SpecError: Not there, not a regular file, too large, or not UTF-8.
    """
    name = shown or str(path)
    try:
        mode = path.stat()
        if not stat.S_ISREG(mode.st_mode):
            kind = "a folder" if stat.S_ISDIR(mode.st_mode) else "not a regular file"
            raise SpecError([Problem(name, 0, 0, f"this is {kind}; a YAML file is wanted")])
        if mode.st_size > LARGEST_FILE:
            size = f"{mode.st_size / 1e6:.1f} MB; at most {LARGEST_FILE / 1e6:.0f} MB are read"
            raise SpecError([Problem(name, 0, 0, f"the file has {size}")])
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        missing = isinstance(error, FileNotFoundError)
        message = "there is no such file" if missing else f"cannot be read: {reason}"
        raise SpecError([Problem(name, 0, 0, message)]) from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", errors="replace")
        source = Source.of_text(name, data.decode("utf-8-sig", errors="replace"))
        hint = "save the file as UTF-8"
        raise SpecError([_at_end_of(before, source).problem("not UTF-8 text", hint)]) from error


def parse_yaml(text: str, source: Source) -> Located:
    """The one document of a text; a mapping.

    Raises:
        SpecError: With every duplicate key, tag and number that cannot be; with a syntax error
            alone, as nothing behind it can be trusted.
    """
    composer = _Composer(source)
    try:
        root = composer.document(text)
    except yaml.MarkedYAMLError as error:
        raise SpecError([_syntax(error, source)]) from error
    except yaml.reader.ReaderError as error:
        place = _at_end_of(text[: error.position], source)
        raise SpecError([place.problem("a control character cannot be in YAML text")]) from error
    if composer.problems:
        raise SpecError(composer.problems)
    if root is None:
        raise SpecError([Problem(source.path, 0, 0, "the file is empty")])
    if not isinstance(root.value, dict):
        message = "a file is a mapping: lines of `key: value`"
        raise SpecError([root.place.problem(message)])
    return root


def parse_value(text: str, source: Source) -> Located:
    """A value given as an option: one YAML scalar, `[list]` or `{mapping: of}` such.

    Raises:
        SpecError: It is not YAML.
    """
    composer = _Composer(source)
    try:
        root = composer.document(text)
    except (yaml.MarkedYAMLError, yaml.reader.ReaderError) as error:
        message = f"`{text}` is not a YAML value"
        raise SpecError(
            [Place(source).problem(message, "quote text with special characters")]
        ) from error
    if composer.problems:
        raise SpecError(composer.problems)
    return Located(None, Place(source)) if root is None else root.moved(Place(source))


def is_plain_text(text: str) -> bool:
    """Whether a text without quotes is text: by the core schema no number, boolean or null."""
    patterns = (INTEGER, FLOAT, BASED, NOT_FINITE)
    return text not in CONSTANTS and not any(each.fullmatch(text) for each in patterns)


class _Composer:
    """Composes events into located values; goes on after a mistake, collecting problems."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Problem] = []
        self._anchors: dict[str, Located] = {}
        self._sizes: dict[str, tuple[int, int]] = {}  # values and depth behind an anchor
        self._count = 0

    def document(self, text: str) -> Located | None:
        reader: Any = yaml
        events: Iterator[Any] = reader.parse(text, Loader=LOADER)
        root: Located | None = None
        for event in events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root is not None:
                    place = self._place(event)
                    raise SpecError([place.problem("a file is one document; a second begins here")])
                root = self._value(next(events), events, 1)
        is_nothing = root is not None and root.value is None and root.place.length == 0
        return None if is_nothing else root

    def _value(self, event: Any, events: Iterator[Any], depth: int) -> Located:
        place = self._place(event)
        self._count += 1
        self._bound(place, depth)
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event, place, depth)
        if event.tag is not None and event.tag != "!":
            hint = 'tags have no meaning here; put the value in "quotes" to make it text'
            self.problems.append(place.problem(f"`{_short_tag(event.tag)}` is a tag", hint))
        before = self._count
        item = Located(None, place)
        if isinstance(event, yaml.SequenceStartEvent):
            item.value = self._list(events, depth)
        elif isinstance(event, yaml.MappingStartEvent):
            item.value = self._mapping(events, depth)
        else:
            item.value = self._scalar(event, place)
        if event.anchor is not None:
            self._anchors[event.anchor] = item
            self._sizes[event.anchor] = (self._count - before + 1, _depth(item))
        return item

    def _list(self, events: Iterator[Any], depth: int) -> list[Located]:
        items: list[Located] = []
        for event in events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            items.append(self._value(event, events, depth + 1))
        return items

    def _mapping(self, events: Iterator[Any], depth: int) -> dict[str, Entry]:
        entries: dict[str, Entry] = {}
        for event in events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            place = self._place(event)
            key = self._key(event, events, depth)
            value = self._value(next(events), events, depth + 1)
            if key is None:
                continue
            if key in entries:
                first = f"the first is in line {entries[key].key.line}"
                self.problems.append(place.problem(f"the key `{key}` is here twice", first))
            else:
                entries[key] = Entry(place, value)
        return entries

    def _key(self, event: Any, events: Iterator[Any], depth: int) -> str | None:
        """A key's text; keys are names, whatever they look like."""
        place = self._place(event)
        item = self._value(event, events, depth + 1) if _is_nested(event) else None
        if item is not None and isinstance(item.value, dict | list):
            self.problems.append(place.problem("a key is text, not a list or a mapping"))
            return None
        key = str(item.value) if item is not None else str(event.value)
        if key == "<<" and item is None and event.implicit[0]:
            hint = "repeat the keys, or alias the whole mapping: `key: *anchor`"
            self.problems.append(place.problem("merge keys (`<<`) are not part of YAML 1.2", hint))
            return None
        return key

    def _alias(self, event: Any, place: Place, depth: int) -> Located:
        if event.anchor not in self._anchors:
            hint = "an anchor `&name` stands before its alias; quote text that begins with `*`"
            message = f"no complete anchor is called `{event.anchor}`"
            raise SpecError([place.problem(message, hint)])
        size, height = self._sizes[event.anchor]
        self._count += size
        self._bound(place, depth + height - 1)
        return self._anchors[event.anchor]

    def _scalar(self, event: Any, place: Place) -> Scalar:
        text = str(event.value)
        if not event.implicit[0] or event.style in ("'", '"', "|", ">"):
            return text
        if is_plain_text(text):
            return text
        if text in CONSTANTS:
            return CONSTANTS[text]
        is_number = not NOT_FINITE.fullmatch(text) and len(text) <= LONGEST_NUMBER
        number = _number(text) if is_number else math.inf
        if not math.isfinite(number):
            shown = text if len(text) <= 40 else text[:40] + "..."
            self.problems.append(place.problem(f"`{shown}` is not a finite number"))
            return 0
        return number

    def _bound(self, place: Place, depth: int) -> None:
        if depth > DEEPEST:
            raise SpecError([place.problem(f"nested more than {DEEPEST} levels deep")])
        if self._count > LARGEST_TREE:
            message = f"more than {LARGEST_TREE} values, aliases expanded"
            raise SpecError([place.problem(message)])

    def _place(self, event: Any) -> Place:
        start, end = event.start_mark, event.end_mark
        is_scalar = isinstance(event, yaml.ScalarEvent)
        if is_scalar and end.line != start.line:
            length = len(self.source.line(start.line + 1)) - start.column
        else:
            length = end.column - start.column if is_scalar else 1
        return Place(self.source, start.line + 1, start.column + 1, length)


def _number(text: str) -> int | float:
    if INTEGER.fullmatch(text):
        return int(text)
    return int(text, 0) if BASED.fullmatch(text) else float(text)


def _depth(item: Located) -> int:
    children = [entry.value for entry in item.mapping().values()] + item.items()
    return 1 + max(map(_depth, children), default=0)


def _is_nested(event: Any) -> bool:
    return not isinstance(event, yaml.ScalarEvent) or event.tag not in (None, "!")


def _short_tag(tag: str) -> str:
    return tag.replace("tag:yaml.org,2002:", "!!")


def _at_end_of(before: str, source: Source) -> Place:
    lines = Source.of_text("", before).lines
    return Place(source, len(lines), len(lines[-1]) + 1)


def _syntax(error: yaml.MarkedYAMLError, source: Source) -> Problem:
    """Where the parser gave up, in plainer words; an unclosed quote where it began."""
    said = error.problem or "this is not YAML"
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return Problem(source.path, 0, 0, said)
    place = Place(source, mark.line + 1, mark.column + 1)
    character = source.line(place.line)[mark.column : mark.column + 1]
    if "cannot start any token" in said:
        if character == "\t":
            return place.problem("a tab cannot indent YAML", "use spaces")
        return place.problem(
            f"a plain value cannot begin with `{character}`", "put it in quotes if it is text"
        )
    opened = error.context_mark
    is_open = "or ']'" in said or "or '}'" in said or not source.line(place.line).strip()
    if opened is not None and is_open:
        place = Place(source, opened.line + 1, opened.column + 1)
    hint = next((plainer for words, plainer in PLAINER if words in said), "")
    if not hint:
        return place.problem(f"not YAML: {said}")
    return place.problem(f"not YAML: {hint}")
