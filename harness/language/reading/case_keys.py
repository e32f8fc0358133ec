"""The keys of a scenario file that say which cases there are, read alone."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf

from harness.core.errors import Problem, SpecError
from harness.language.files.source import Entry, Located, Place, Source
from harness.language.reading.overrides import Override, apply_overrides, value_at
from harness.language.reading.params import filled, mapped, parameters
from harness.language.reading.short_forms import models_shape
from harness.language.variation import CaseKeys

DRAWN = "\0"  # stands for the value of a case, which no file and no option can contain


def read_case_keys(entries: Mapping[str, Entry], problems: list[Problem]) -> CaseKeys:
    """The keys of a file's cases; the whole file is read with the same model.

    Args:
        entries: The values of these keys, parameters and options applied; other keys are ignored.

    Raises:
        ValueError, SpecError: They have a mistake, which reading the whole file reports.
    """
    own = {key: entry for key, entry in entries.items() if key in CaseKeys.model_fields}
    shaped = models_shape(Located(own, Place(Source(""))), CaseKeys, problems)
    if problems:
        raise SpecError(problems)
    return CaseKeys.model_validate(shaped.plain())


def case_entries(root: Located, problems: list[Problem]) -> tuple[dict[str, Entry], set[str]]:
    """The keys of a file's cases with `${name}` replaced, and the names of these parameters.

    References in values that a case takes are kept: the case itself replaces them.
    """
    params = _NotedParams(parameters(root))

    def fill(item: Located, depth: float) -> Located:
        """A value with its references replaced down to a depth."""
        if depth < 0:
            return item
        if isinstance(item.value, str):
            item = filled(item, params, problems)
        return mapped(item, lambda child: fill(child, depth - 1))

    def fill_distribution(item: Located) -> Located:
        item = fill(item, 0)
        entries = {
            key: Entry(of, fill(kind, 0 if key == "choice" else inf))
            for key, (of, kind) in item.mapping().items()
        }
        return Located(entries, item.place) if entries else fill(item, inf)

    def fill_key(key: str, item: Located) -> Located:
        if key == "parametrize":
            return fill(item, 1)
        if key == "randomize":
            return mapped(fill(item, 0), fill_distribution)
        return fill(item, inf)

    entries = {
        key: Entry(of, fill_key(key, item))
        for key, (of, item) in root.mapping().items()
        if key in CaseKeys.model_fields
    }
    return entries, params.used


class _NotedParams(dict[str, Entry]):
    """Parameters; those that are read are noted."""

    def __init__(self, params: Mapping[str, Entry]) -> None:
        super().__init__(params)
        self.used: set[str] = set()

    def __getitem__(self, name: str) -> Entry:
        self.used.add(name)
        return super().__getitem__(name)


def fixed_values(root: Located, keys: CaseKeys, options: list[Override]) -> dict[str, object]:
    """The values of cases that options replace: path in `parametrize` or `randomize` -> value.

    Args:
        root: The file's values, options not applied.
    """
    varied = [*(keys.randomize or {}), *parametrized_paths(keys)]
    drawn = Located(DRAWN, root.place)
    values = [Override(path, drawn, root.place) for path in varied]
    root = apply_overrides(apply_overrides(root, values, []), options, [])
    found = {path: value_at(root, path) for path in varied}
    return {path: value for path, value in found.items() if value != DRAWN}


def parametrized_paths(keys: CaseKeys) -> list[str]:
    """Every path that a parametrised case sets."""
    if isinstance(keys.parametrize, dict):
        return list(keys.parametrize)
    cases = keys.parametrize or ()
    return list(dict.fromkeys(path for case in cases for path in case if path != "id"))
