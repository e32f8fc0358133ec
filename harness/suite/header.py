"""A scenario file's title, tags and cases, read without the rest of the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.core.errors import Problem, SpecError
from harness.core.files import read_at_most
from harness.core.limits import YAML_FILE
from harness.suite.discovery import SUFFIX
from harness.suite.variation import ONE_CASE, Variation

if TYPE_CHECKING:
    from harness.language.files.source import Located

TITLE, TAGS, VERIFIES, PARAMS = "scenario", "tags", "verifies", "params"
CASE_KEYS = frozenset(
    ("parametrize", "randomize", "samples", "redraw_overlaps", "expect_rate", "seed", "search")
)
"""Keys that the cases follow from; a file without any has one case, and is read without models."""


@dataclass(frozen=True)
class ScenarioHeader:
    """What selects a scenario before the whole file is read.

    Attributes:
        title: Its `scenario`; the file's name where there is none.
        line: The line of the title, from 1.
        verifies: Requirements that it names.
        varied: The values that its cases follow from, options applied.
    """

    title: str
    tags: tuple[str, ...] = ()
    line: int = 1
    variation: Variation = ONE_CASE
    verifies: tuple[str, ...] = ()
    varied: Mapping[str, Any] = field(default_factory=dict[str, Any])


def source_lines(file: Path) -> list[str]:
    """Lines of a file, to quote from; none of one that cannot be read."""
    try:
        return read_at_most(file, YAML_FILE).decode("utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return []


def read_header(
    file: Path, overrides: Mapping[str, str] | None = None, text: str | None = None
) -> ScenarioHeader:
    """Read a file's header; for a broken file, whose run reports the problems, only the name.

    Args:
        overrides: Dotted path -> value as YAML, as given with `--set`.
        text: Content that is read in place of the file's.
    """
    from harness.language.files.source import Source
    from harness.language.files.yaml_file import parse_yaml, read_text
    from harness.language.reading.params import substitute

    nameless = ScenarioHeader(file.name.removesuffix(SUFFIX))
    try:
        text = read_text(file) if text is None else text
        written = parse_yaml(text, Source.of_text(str(file), text))
    except SpecError:
        return nameless
    root = _with_options(written, overrides or {})
    heading = {k: e for k, e in root.mapping().items() if k in (TITLE, TAGS, VERIFIES, PARAMS)}
    entries = substitute(type(root)(heading, root.place), []).mapping()
    tags = _texts(entries[TAGS].value) if TAGS in entries else ()
    verifies = _texts(entries[VERIFIES].value) if VERIFIES in entries else ()
    varied, variation = _cases(written, root, overrides or {})
    title, line = nameless.title, 1
    if TITLE in entries:
        key, stated = entries[TITLE]
        line = max(1, key.line)
        if isinstance(stated.value, str) and stated.value.strip():
            title = " ".join(stated.value.split())
    return ScenarioHeader(title, tags, line, variation, verifies, varied)


def _with_options(root: Located, overrides: Mapping[str, str]) -> Located:
    """The file's values with options in their place, where these can change the header."""
    params = root.mapping()[PARAMS].value.mapping() if PARAMS in root.mapping() else {}
    of_header = {TITLE, TAGS, VERIFIES, PARAMS, *CASE_KEYS, *params}
    if not any(path.split(".")[0] in of_header for path in overrides):
        return root
    from harness.language.reading.overrides import apply_overrides, from_options

    problems: list[Problem] = []
    return apply_overrides(root, from_options(overrides, problems), problems)


def _cases(
    written: Located, root: Located, overrides: Mapping[str, str]
) -> tuple[dict[str, Any], Variation]:
    """The values that a file's cases follow from, and the variation that they say.

    Args:
        written: The file's values, options not applied.
        root: The file's values, options applied.
    """
    if not CASE_KEYS & root.mapping().keys():
        return {}, ONE_CASE
    from harness.language.reading.case_keys import case_entries, fixed_values, read_case_keys
    from harness.language.reading.overrides import from_options

    problems: list[Problem] = []
    entries, _ = case_entries(root, problems)
    varied: dict[str, Any] = {key: entry.value.plain() for key, entry in entries.items()}
    try:
        keys = read_case_keys(entries, problems)
    except (ValueError, SpecError):
        return varied, ONE_CASE
    fixed = fixed_values(written, keys, from_options(overrides, [])) if overrides else {}
    return varied, replace(Variation.of(keys), fixed=fixed)


def _texts(item: Located) -> tuple[str, ...]:
    return tuple(each.value for each in item.items() if isinstance(each.value, str) and each.value)
