"""A scenario file's title, tags and cases, read without judging the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.core.errors import SpecError
from harness.suite.discovery import SUFFIX
from harness.suite.variation import ONE_CASE, Variation

if TYPE_CHECKING:
    from harness.language.files.source import Located

VARIED = ("parametrize", "randomize", "samples", "redraw_overlaps", "expect_rate", "seed")


@dataclass(frozen=True)
class ScenarioHeader:
    """What selects a scenario before it is read in earnest.

    Attributes:
        title: Its `scenario`; the file's name where there is none.
        tags: The `tags` of the file.
        line: The line of the title, from 1.
        variation: The variation of the file.
        verifies: Requirements that it names.
        varied: The values in the file that its cases follow from.
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
        return file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return []


def read_header(file: Path) -> ScenarioHeader:
    """Read a file's header; for a broken file, whose run reports the problems, only the name."""
    from harness.language.files.source import Source
    from harness.language.files.yaml_file import parse_yaml, read_text

    nameless = ScenarioHeader(file.name.removesuffix(SUFFIX))
    try:
        text = read_text(file)
        entries = parse_yaml(text, Source.of_text(str(file), text)).mapping()
    except SpecError:
        return nameless
    tags: tuple[str, ...] = ()
    if "tags" in entries:
        tags = _texts(entries["tags"].value)
    verifies = _texts(entries["verifies"].value) if "verifies" in entries else ()
    keys = (*VARIED, "planning") if "randomize" in entries else VARIED
    varied = {key: entries[key].value.plain() for key in keys if key in entries}
    variation = Variation.of(varied)
    if "scenario" not in entries:
        return ScenarioHeader(nameless.title, tags, 1, variation, verifies, varied)
    key, title = entries["scenario"]
    if not isinstance(title.value, str) or not title.value.strip():
        return ScenarioHeader(nameless.title, tags, key.line, variation, verifies, varied)
    plain_title = " ".join(title.value.split())
    return ScenarioHeader(plain_title, tags, key.line, variation, verifies, varied)


def _texts(item: Located) -> tuple[str, ...]:
    return tuple(each.value for each in item.items() if isinstance(each.value, str) and each.value)
