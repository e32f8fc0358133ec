"""Third-party YAML files for a robot, with located errors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NoReturn

from harness.core.errors import SpecError
from harness.core.quantity import split_quantity
from harness.core.suggestion import did_you_mean
from harness.language.files.source import Entry, Located, Source
from harness.language.files.yaml_file import parse_yaml, read_text, require_key
from harness.plugins.formats.unit_tags import UnitComposer


def read_data(path: Path, keys: Sequence[str], kind: str) -> Located:
    """The mapping at the top of a file.

    Args:
        path: The path of the file.
        keys: Keys of which it has at least one.
        kind: Kind of the file, for messages.

    Raises:
        SpecError: It is of another kind, or not YAML; at line and column.
    """
    text = read_text(path)
    require_key(text, keys, str(path), kind)
    source = Source.of_text(str(path), text)
    return parse_yaml(text, source, composer=UnitComposer(source, _plain_number))


def _plain_number(text: str) -> float:
    value, unit = split_quantity(text)
    if unit:
        raise ValueError(f"`{text}` has a unit and a tag")
    return value


def number(item: Located) -> float:
    """A finite number.

    Raises:
        SpecError: It is not a finite number.
    """
    value = item.value
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        refuse(item, f"expected a number, found '{item.plain()}'")
    return float(value)


def known_entry(
    entries: dict[str, Entry], name: str, known: Iterable[str], kind: str, robot: str
) -> Located:
    """The value of a key that names a part of the robot.

    Raises:
        SpecError: The robot has no part of that name; at the key.
    """
    names = list(known)
    if name not in names:
        hint = did_you_mean(name, names, f"{kind}s")
        problem = entries[name].key.problem(f"'{robot}' has no {kind} '{name}'", hint)
        raise SpecError([problem])
    return entries[name].value


def refuse(item: Located, message: str, hint: str = "") -> NoReturn:
    """Raise a mistake at a value."""
    raise SpecError([item.place.problem(message, hint)])
