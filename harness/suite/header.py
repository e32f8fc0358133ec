"""A scenario file's title and tags, read without judging the file."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

from harness.suite.discovery import SUFFIX


@dataclass(frozen=True)
class Header:
    """What selects a scenario before it is read in earnest.

    Attributes:
        title: Its `scenario`; the file's name where there is none.
        tags: Its `tags`.
        line: Of the title, from 1.
    """

    title: str
    tags: tuple[str, ...] = ()
    line: int = 1


def read_header(file: Path) -> Header:
    """Read a file's header; of a broken file, which tells its problems later, the name."""
    import yaml

    title, tags, line = file.name.removesuffix(SUFFIX), (), 1
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    with contextlib.suppress(yaml.YAMLError, OSError, UnicodeDecodeError, RecursionError):
        root = yaml.compose(file.read_text(encoding="utf-8"), Loader=loader)
        if isinstance(root, yaml.MappingNode):
            for key, value in root.value:
                if key.value == "scenario" and isinstance(value, yaml.ScalarNode):
                    title, line = value.value.strip() or title, key.start_mark.line + 1
                elif key.value == "tags" and isinstance(value, yaml.SequenceNode):
                    tags = tuple(
                        item.value for item in value.value if isinstance(item, yaml.ScalarNode)
                    )
    return Header(title, tags, line)
