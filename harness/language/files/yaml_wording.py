"""Plain messages for libyaml's errors on files that are not YAML."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import yaml

from harness.core.errors import Problem
from harness.core.limits import YAML_LEVELS
from harness.core.registry import Plugin, registry
from harness.language.files.source import Place, Source

TOO_DEEP = f"nested more than {YAML_LEVELS} levels deep"

PLAINER = (
    ("mapping values are not allowed", "a second `:` here; quote text that contains `: `"),
    ("found undefined alias", "no anchor has this name; text that begins with `*` needs quotes"),
    ("found unexpected end of stream", "the text that begins here is not closed"),
    ("did not find expected ',' or ']'", "this list is not closed, or a comma is missing"),
    ("did not find expected ',' or '}'", "this mapping is not closed, or a comma is missing"),
    ("block sequence entries are not allowed", "a list begins on a line of its own, below its key"),
    ("found unexpected ':'", "a `:` between brackets needs a space after it, or quotes around it"),
    (
        "did not find expected key",
        "what stands before this has ended; quote text that goes on here",
    ),
    ("comment or line break", "only a line of text, or a comment, can follow `|` or `>`"),
    ("did not find expected node content", "a value is missing, or a bracket is not closed"),
)
"""What libyaml says -> what a person would say."""


class SyntaxAdviser(Plugin, ABC):
    """Says of a file that is not YAML which line to change, and how."""

    plugin_kind: ClassVar[str] = "syntax_adviser"

    @abstractmethod
    def problem(
        self, error: yaml.MarkedYAMLError, mark: yaml.Mark, source: Source
    ) -> Problem | None:
        """The mistake, at the line to change; None: this is not known."""


def syntax_problem(error: yaml.MarkedYAMLError, source: Source) -> Problem:
    """Where the parser gave up, in plainer words; an unclosed quote where it began."""
    reason = error.problem or "this is not YAML"
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return Problem(source.path, 0, 0, reason)
    place = place_of(mark, source)
    if "maximum nesting depth" in reason:  # the scanner's own limit, where it reads far ahead
        return place.problem(TOO_DEEP)
    character = source.line(place.line)[mark.column : mark.column + 1]
    if "cannot start any token" in reason:
        if character == "\t":
            return place.problem("a tab cannot indent YAML", "use spaces")
        return place.problem(
            f"a plain value cannot begin with `{character}`", "put it in quotes if it is text"
        )
    opened = error.context_mark
    is_open = "or ']'" in reason or "or '}'" in reason or not source.line(mark.line + 1).strip()
    if opened is not None and is_open:
        place = place_of(opened, source)
    for adviser in registry(SyntaxAdviser.plugin_kind).built_in():
        laid_out = adviser().problem(error, mark, source)
        if laid_out is not None:
            return laid_out
    hint = next((plainer for words, plainer in PLAINER if words in reason), "")
    if not hint:
        return place.problem(f"not YAML: {reason}")
    return place.problem(f"not YAML: {hint}")


def place_of(mark: yaml.Mark, source: Source) -> Place:
    """A mark's place; after the last line: the end of the last that says something."""
    if source.line(mark.line + 1).strip():
        return Place(source, mark.line + 1, mark.column + 1)
    written = [number for number in range(1, mark.line + 2) if source.line(number).strip()]
    last = written[-1] if written else 1
    return Place(source, last, len(source.line(last).rstrip()) + 1)
