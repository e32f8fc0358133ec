"""Reads a YAML file into values with places: YAML 1.2 scalars, bounded, without tags.

libyaml's events are composed here and not by its own composer: that one calls itself for every
level and ends the process on a file of brackets, resolves scalars by YAML 1.1 (`on` is true,
`1e-3` is text), and drops duplicate keys.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

import yaml

from harness.core.errors import Problem, SpecError
from harness.core.inputs import read_bounded
from harness.core.limits import YAML_FILE, YAML_LEVELS, YAML_VALUES
from harness.language.files.source import Entry, Located, Place, Scalar, Source
from harness.language.files.yaml_scalars import scalar_of
from harness.language.files.yaml_wording import TOO_DEEP, syntax_problem

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_text(path: Path, *, kind: str = "YAML file", largest: int = YAML_FILE) -> str:
    """The text of a file.

    Args:
        kind: What it should be, for messages.
        largest: Bytes that it may have.

    Raises:
        SpecError: Not there, not a regular file, too large, or not UTF-8.
    """
    data = read_bounded(path, kind, largest)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", errors="replace")
        source = Source.of_text(str(path), data.decode("utf-8-sig", errors="replace"))
        hint = "save the file as UTF-8"
        raise SpecError([source.end_of(before).problem("not UTF-8 text", hint)]) from error


def require_key(text: str, keys: Sequence[str], name: str, kind: str) -> None:
    """See that a text has a key of its kind of file, before any of it is quoted in a message.

    A scenario can name any file of the machine, and its messages may be read by somebody else.

    Raises:
        SpecError: It has none of the keys; the message has nothing of the text.
    """
    words = "|".join(map(re.escape, keys))
    if re.search(rf"""(?:^|[{{,\s])["']?(?:{words})["']?\s*:""", text, re.MULTILINE) is None:
        found = " or ".join(f"`{key}`" for key in keys)
        raise SpecError([Problem(name, 0, 0, f"this is no {kind}: it has no key {found}")])


def parse_yaml(
    text: str,
    source: Source,
    problems: list[Problem] | None = None,
    composer: Composer | None = None,
) -> Located:
    """The one document of a text; a mapping.

    Args:
        problems: Gets every duplicate key, tag and number that is not finite, so that the rest of
            the file can be read as well; None: they are raised.

    Raises:
        SpecError: A syntax error, after which nothing can be trusted, or no mapping.
    """
    composer = composer or Composer(source)
    root = composer.read(text)
    is_mapping = root is not None and isinstance(root.value, dict)
    if composer.problems and (problems is None or not is_mapping):
        raise SpecError(composer.problems)
    if root is None:
        raise SpecError([Problem(source.path, 0, 0, "the file is empty")])
    if not is_mapping:
        message = "a file is a mapping: lines of `key: value`"
        raise SpecError([root.place.problem(message)])
    if problems is not None:
        problems += composer.problems
    return root


def parse_value(text: str, source: Source) -> Located:
    """A value given as an option: one YAML scalar, `[list]` or `{mapping: of}` such.

    Raises:
        SpecError: It is not YAML.
    """
    composer = Composer(source)
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


class Composer:
    """Composes events into located values; continues after a mistake, collecting problems.

    Attributes:
        tags: Tags of scalars that `_scalar` reads; all others are mistakes.
    """

    has_merge_keys = False
    tags: ClassVar[Collection[str]] = ()

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Problem] = []
        self._anchors: dict[str, Located] = {}
        self._sizes: dict[str, tuple[int, int]] = {}  # values and depth of an anchor
        self._count = 0

    def read(self, text: str) -> Located | None:
        """The document of a text; a SpecError is its syntax error."""
        try:
            return self.document(text)
        except yaml.MarkedYAMLError as error:
            raise SpecError([syntax_problem(error, self.source)]) from error
        except yaml.reader.ReaderError as error:
            place = self.source.end_of(text[: error.position])
            message = "a control character cannot be in YAML text"
            raise SpecError([place.problem(message)]) from error

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
        is_scalar = isinstance(event, yaml.ScalarEvent)
        if event.tag not in (None, "!") and not (is_scalar and event.tag in self.tags):
            hint = 'tags have no meaning here; put the value in "quotes" to make it text'
            if is_scalar and event.tag in ("!degrees", "!radians"):
                hint = f"write `{event.value} {event.tag[1:4]}`"
            short = event.tag.replace("tag:yaml.org,2002:", "!!")
            self.problems.append(place.problem(f"`{short}` is a tag", hint))
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
            key = self._key(event, events, depth, place)
            value = self._value(next(events), events, depth + 1)
            if key is not None:
                self._put(entries, key, place, value)
        return entries

    def _put(self, entries: dict[str, Entry], key: str, place: Place, value: Located) -> None:
        if key in entries:
            first = f"the first is in line {entries[key].key.line}"
            self.problems.append(place.problem(f"the key `{key}` is here twice", first))
        else:
            entries[key] = Entry(place, value)

    def _key(self, event: Any, events: Iterator[Any], depth: int, place: Place) -> str | None:
        """A key's text; keys are names, whatever they look like."""
        item = self._value(event, events, depth + 1) if _is_nested(event) else None
        if item is not None and isinstance(item.value, dict | list):
            self.problems.append(place.problem("a key is text, not a list or a mapping"))
            return None
        key = str(item.value) if item is not None else str(event.value)
        if key == "<<" and item is None and event.implicit[0] and not self.has_merge_keys:
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
        try:
            return self._scalar_of(text)
        except OverflowError:
            shown = text if len(text) <= 40 else text[:40] + "..."
            self.problems.append(place.problem(f"`{shown}` is not a finite number"))
            return 0

    def _scalar_of(self, text: str) -> Scalar:
        return scalar_of(text)

    def _bound(self, place: Place, depth: int) -> None:
        if depth > YAML_LEVELS:
            raise SpecError([place.problem(TOO_DEEP)])
        if self._count > YAML_VALUES:
            message = f"more than {YAML_VALUES} values, aliases expanded"
            raise SpecError([place.problem(message)])

    def _place(self, event: Any) -> Place:
        start, end = event.start_mark, event.end_mark
        is_scalar = isinstance(event, yaml.ScalarEvent)
        if is_scalar and end.line != start.line:
            length = len(self.source.line(start.line + 1)) - start.column
        else:
            length = end.column - start.column if is_scalar else 1
        return Place(self.source, start.line + 1, start.column + 1, length)


def _depth(item: Located) -> int:
    children = [entry.value for entry in item.mapping().values()] + item.items()
    return 1 + max(map(_depth, children), default=0)


def _is_nested(event: Any) -> bool:
    return not isinstance(event, yaml.ScalarEvent) or event.tag not in (None, "!")
