"""What libyaml says of a file that is not YAML, as a person would say it."""

from __future__ import annotations

import yaml

from harness.core.errors import Problem
from harness.spec.source import Place, Source

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


def syntax_problem(error: yaml.MarkedYAMLError, source: Source) -> Problem:
    """Where the parser gave up, in plainer words; an unclosed quote where it began."""
    said = error.problem or "this is not YAML"
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return Problem(source.path, 0, 0, said)
    place = _place(mark, source)
    character = source.line(place.line)[mark.column : mark.column + 1]
    if "cannot start any token" in said:
        if character == "\t":
            return place.problem("a tab cannot indent YAML", "use spaces")
        return place.problem(
            f"a plain value cannot begin with `{character}`", "put it in quotes if it is text"
        )
    opened = error.context_mark
    is_open = "or ']'" in said or "or '}'" in said or not source.line(mark.line + 1).strip()
    if opened is not None and is_open:
        place = _place(opened, source)
    hint = next((plainer for words, plainer in PLAINER if words in said), "")
    if not hint:
        return place.problem(f"not YAML: {said}")
    return place.problem(f"not YAML: {hint}")


def _place(mark: yaml.Mark, source: Source) -> Place:
    """A mark's place; behind the last line: the end of the last that says something."""
    if source.line(mark.line + 1).strip():
        return Place(source, mark.line + 1, mark.column + 1)
    said = [number for number in range(1, mark.line + 2) if source.line(number).strip()]
    last = said[-1] if said else 1
    return Place(source, last, len(source.line(last).rstrip()) + 1)
