"""Dotted paths of values that vary: each must be one of the file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from harness.core.errors import Problem, SpecError
from harness.spec.mistakes import did_you_mean
from harness.spec.params import PARAMS, override
from harness.spec.source import Entry, Located
from harness.spec.variation import VARIATION_KEYS


def check_paths(root: Located, keys: tuple[str, ...], problems: list[Problem]) -> None:
    """See that every value that is varied is one of the file; mistakes are added to `problems`."""
    entries = root.mapping()
    params = tuple(entries[PARAMS].value.mapping()) if PARAMS in entries else ()
    varied = list(_parametrized(root))
    if "randomize" in entries:
        varied += entries["randomize"].value.mapping().items()
    for path, entry in varied:
        first, _, name = path.partition(".")
        if first in VARIATION_KEYS:
            problems.append(entry.key.problem(f"`{path}` itself cannot be varied"))
            continue
        if first == PARAMS and name.partition(".")[0] not in params:
            hint = did_you_mean(name, params, "parameters of the file")
            problems.append(entry.key.problem(f"no parameter is called `{name}`", hint))
            continue
        try:
            override(root, {path: "null"}, keys)
        except SpecError as error:
            problems += [entry.key.problem(each.message, each.hint) for each in error.problems]


def values_of_case(root: Located, overrides: Mapping[str, str]) -> dict[str, Located]:
    """Overrides that are values of `parametrize`, where they stand in the file.

    Args:
        root: The file as written.
        overrides: Dotted path -> value as JSON.
    """
    found: dict[str, Located] = {}
    for path, entry in _parametrized(root):
        if path not in overrides or path in found:
            continue
        for value in (*entry.value.items(), entry.value):
            if json.dumps(value.plain(), ensure_ascii=False) == overrides[path]:
                found[path] = value
                break
    return found


def _parametrized(root: Located) -> Iterator[tuple[str, Entry]]:
    """Path and entry of every line of a grid, or of every named case."""
    entry = root.mapping().get("parametrize")
    if entry is None:
        return
    yield from entry.value.mapping().items()
    for case in entry.value.items():
        for path, item in case.mapping().items():
            if path != "id":
                yield path, item
