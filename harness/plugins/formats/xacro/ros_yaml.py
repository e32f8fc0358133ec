"""YAML as xacro's `load_yaml` reads it: YAML 1.1, and units."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import yaml

from harness.core.errors import SpecError
from harness.language.files.source import Entry, Located, Place, Scalar, Source
from harness.plugins.formats.unit_tags import UnitComposer

YAML_11: Any = yaml.SafeLoader("")
KINDS = tuple(f"tag:yaml.org,2002:{kind}" for kind in ("null", "bool", "int", "float"))


def parse_ros_yaml(text: str, source: Source, number: Callable[[str], float]) -> Located:
    """The one document of a text; scalars and merge keys (`<<`) are those of YAML 1.1.

    Args:
        number: The number of a text after a tag of UNITS, or a ValueError.

    Raises:
        SpecError: It is not YAML, or has another tag.
    """
    composer = _RosComposer(source, number)
    root = composer.read(text)
    if composer.problems:
        raise SpecError(composer.problems)
    return root or Located(None, Place(source))


class _RosComposer(UnitComposer):
    """Composes YAML 1.1, of whose duplicate keys the last one counts."""

    has_merge_keys = True

    def _put(self, entries: dict[str, Entry], key: str, place: Place, value: Located) -> None:
        if key != "<<":
            entries[key] = Entry(place, value)
            return
        own = dict(entries)
        entries.clear()
        for each in (value.items() or [value])[::-1]:
            entries.update(each.mapping())
        entries.update(own)

    def _scalar_of(self, text: str) -> Scalar:
        """The value of a text without quotes: `yes` is true, `010` is 8, `1e3` is text."""
        tag = YAML_11.resolve(yaml.ScalarNode, text, (True, False))
        if tag not in KINDS:
            return text
        try:
            return YAML_11.yaml_constructors[tag](YAML_11, yaml.ScalarNode(tag, text))
        except ValueError:
            return text
