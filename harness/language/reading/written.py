"""Models as a file writes them: the inverse of `short_forms`, for scenarios built in Python."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, cast

from harness.language.base import SpecModel
from harness.language.expectation import ExpectationFields, TemporalFields
from harness.language.files.source import Place, Source, located
from harness.language.files.yaml_text import yaml_text
from harness.language.language import KEYS_BY_PREDICATE, KEYS_BY_VERB, UNTIL
from harness.language.reading.params import escaped
from harness.language.scenario import Scenario
from harness.language.step import StepFields


def scenario_text(scenario: Scenario) -> str:
    """A scenario as the text of a file that loads to the same model; numbers are in SI units."""
    root = located(as_written(scenario), Place(Source("a scenario built in Python")))
    return yaml_text(escaped(root), block_keys=("steps", "expect"))


def as_written(value: object) -> Any:
    """A model, or what it holds, as plain data in the shape of a file."""
    if isinstance(value, SpecModel):
        entries = _entries(value)
        if isinstance(value, StepFields):
            return _one_word(value.verb, entries, KEYS_BY_VERB)
        if isinstance(value, TemporalFields):
            word = "always" if value.word == UNTIL else value.word
            return {word: entries.pop("predicate"), **entries}
        if isinstance(value, ExpectationFields):
            return _one_word(value.word, entries, KEYS_BY_PREDICATE)
        return entries
    if isinstance(value, Mapping):
        items = cast("Mapping[str, object]", value).items()
        return {key: as_written(item) for key, item in items}
    if isinstance(value, tuple | list):
        return [as_written(item) for item in cast("list[object]", value)]
    return value


def _one_word(word: str, entries: dict[str, Any], outside: Collection[str]) -> dict[str, Any]:
    """A verb or predicate with its content, and the keys next to it."""
    inside = {key: value for key, value in entries.items() if key not in outside}
    return {word: inside, **{key: value for key, value in entries.items() if key in outside}}


def _entries(model: SpecModel) -> dict[str, Any]:
    """The fields that were given, by the names that files have."""
    fields = type(model).model_fields
    return {
        field.alias or name: as_written(getattr(model, name))
        for name, field in fields.items()
        if name in model.model_fields_set
    }
