"""Mistakes of colons and indentation in YAML, at the line to change."""

from __future__ import annotations

import re
from typing import ClassVar

import yaml

from harness.core.errors import Problem
from harness.language.files.source import Place, Source
from harness.language.files.yaml_wording import SyntaxAdviser, place_of


class Layout(SyntaxAdviser):
    """A mistake of colons or indentation; libyaml notices it a line or more after it was made."""

    name: ClassVar[str] = "layout"

    def problem(
        self, error: yaml.MarkedYAMLError, mark: yaml.Mark, source: Source
    ) -> Problem | None:
        reason, opened = error.problem or "", error.context_mark
        line = source.line(mark.line + 1)
        is_inside_line = bool(line[: mark.column].strip()) and "block" in (error.context or "")
        if opened is not None and (opened.line == mark.line or is_inside_line):
            return None
        if "could not find expected ':'" in reason and opened is not None:
            if not _has_content(source.line(opened.line + 1)):
                return None
            return _no_colon(opened.line + 1, source)
        if "mapping values are not allowed" in reason:
            return _key_after_text(mark, source)
        if "did not find expected '-' indicator" in reason and opened is not None:
            return _no_list_item(mark, opened, source)
        if "did not find expected key" in reason and opened is not None:
            return _no_key(mark, opened, source)
        return None


def _no_colon(line: int, source: Source) -> Problem:
    """A line of a mapping that is text without `: `."""
    place = _start(line, source)
    text = source.line(line)[place.column - 1 :].split(" #")[0].strip()
    first, *value = text.split(None, 1)
    glued = re.match(r"([^\s:\"']+):(\S.*)", text)
    if glued is not None:
        hint = f"write `{glued[1]}: {glued[2]}`"
        return place.problem("not YAML: a space is missing after the colon", hint)
    if first == "-" or first.startswith("-"):
        return place.problem("not YAML: a space is missing after the dash", f"`- {first[1:]}`")
    hint = f"write `{' '.join([f'{first}:', *value])}`"
    return place.problem("not YAML: a key ends with `: `, and this line has none", hint)


def _key_after_text(mark: yaml.Mark, source: Source) -> Problem | None:
    """A key where the value before it has not ended: its own line, or the one above, is wrong."""
    number = mark.line + 1
    before = source.line(number)[: mark.column].strip().removeprefix("- ")
    if ": " in before or before.startswith(("'", '"', "{", "[")):
        return None
    above = next((n for n in range(number - 1, 0, -1) if _has_content(source.line(n))), 0)
    if not above:
        return None
    text = source.line(above)[_start(above, source).column - 1 :].split(" #")[0]
    if not text.strip() or text.lstrip().startswith(("[", "{", "'", '"')):
        return None
    if re.search(r":(\s|$)", text) is None:
        return _no_colon(above, source)
    column = _start(above, source).column
    return _start(number, source).problem(
        f"not YAML: this line is indented further than line {above}, whose key has a value",
        f"begin it in column {column}, like that key",
    )


def _no_list_item(mark: yaml.Mark, opened: yaml.Mark, source: Source) -> Problem:
    """A key among the items of a list: one of the item above, or a new item."""
    place = place_of(mark, source)
    items = (n for n in range(mark.line, 0, -1) if _is_item(source.line(n), opened.column))
    above = next(items, opened.line + 1)
    column = _start(above, source).column
    return place.problem(
        f"not YAML: the list from line {opened.line + 1} on goes on with `- ` in column "
        f"{opened.column + 1}, and this line has none",
        f"begin it in column {column} if it belongs to the item of line {above}; "
        "put `- ` in front of it if it is a new item",
    )


def _no_key(mark: yaml.Mark, opened: yaml.Mark, source: Source) -> Problem:
    """A line that is no key of the mapping above it: a list item, or another indentation."""
    place = place_of(mark, source)
    lines_above = [
        n for n in range(place.line - 1, opened.line, -1) if _has_content(source.line(n))
    ]
    is_item = _is_item(source.line(place.line), mark.column)
    if is_item and place.column == opened.column + 1:
        items = [n for n in lines_above if source.line(n).lstrip().startswith("- ")]
        if not items:
            return place_of(opened, source).problem(
                f"not YAML: this line begins with a key, and line {place.line}, in the same"
                " column, begins a list item",
                "put `- ` in front of this line if it is an item too, and indent its other keys",
            )
        lines_above = items[:1]
    columns = {_indentation(source.line(n)): n for n in (opened.line + 1, lines_above[0])}
    if not is_item:
        columns = {_start(n, source).column: n for n in (opened.line + 1, lines_above[0])}
    choices = [
        f"in column {column} like line {line}"
        for column, line in columns.items()
        if column != place.column
    ]
    return place.problem(
        f"not YAML: {'this list item' if is_item else 'this line'} begins in column"
        f" {place.column}, and fits no line above it",
        f"begin it {' or '.join(choices)}",
    )


def _start(line: int, source: Source) -> Place:
    """Where a line's text begins, after the dash of a list item."""
    match = re.match(r"\s*(?:-\s+)?", source.line(line))
    return Place(source, line, 1 + (match.end() if match else 0))


def _indentation(line: str) -> int:
    """The column in which a line's text or dash begins."""
    return 1 + len(line) - len(line.lstrip())


def _has_content(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith("#")


def _is_item(line: str, column: int) -> bool:
    return line[column:].startswith("-") and not line[:column].strip()
