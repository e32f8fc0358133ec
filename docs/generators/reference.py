"""The reference of scenario files and steps as Markdown, made from the models."""

from __future__ import annotations

import types
from collections.abc import Collection, Iterable, Mapping
from typing import Annotated, Any, Literal, Union, cast, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo

from docs.generators.worked_examples import example
from harness.core.errors import ErrorCode
from harness.core.registry import OWN_PACKAGE
from harness.language.annotations import description_of, is_model, keys_of, plugin_model
from harness.language.base import SpecModel
from harness.language.expectation import ExpectationFields
from harness.language.language import KEYS_BY_VERB
from harness.language.scenario import Scenario
from harness.language.step import STEPS, StepFields
from harness.language.units import MEANINGS, SHARE
from harness.language.world import WorldSpec

KINDS: dict[Any, str] = {str: "text", float: "number", int: "whole number", bool: "true or false"}


VALUES = """\
Numbers are SI and radians. Where a unit is given in brackets, a number may also be text with
another unit: `5 cm`, `90 deg`, `200 ms`. `${name}` is replaced by a parameter of the file. Only
keys that are marked as required are mandatory."""
STEPS_HEAD = """\
A step is one verb with its content, and keys next to the verb:

```yaml
- move_to:
    pose: {frame: base_link, xyz: [0.32, -0.17, 0.3], rpy: [180 deg, 0, 0]}
  id: above
  expect: [{tcp_pose: {pose: {frame: base_link, xyz: [0.32, -0.17, 0.3]}, position_only: true}}]
```"""


def scenario_reference() -> str:
    """The keys of a scenario file and of a world file."""
    parts = ["# Scenario and world files", VALUES]
    for title, model in (("Scenario file", Scenario), ("World file", WorldSpec)):
        parts += [f"## {title}", description_of(model), table(keys_of(model).items())]
    return "\n\n".join([*parts, *part_sections((Scenario, WorldSpec))]) + "\n"


def steps_reference() -> str:
    """Every verb: what it does, its keys with type, unit and default."""
    next_to = table((key, keys_of(StepFields)[key]) for key in KEYS_BY_VERB)
    parts = ["# Steps", STEPS_HEAD, VALUES, contents(STEPS)]
    parts += ["Every step also has these keys, next to its verb:", next_to]
    parts.append(f"Error codes are {', '.join(f'`{code}`' for code in get_args(ErrorCode))}.")
    for verb, model in STEPS.items():
        package = STEPS.package_of(verb)
        notes = [] if package == OWN_PACKAGE else [f"This step comes from the package `{package}`."]
        parts += section(verb, model, KEYS_BY_VERB, notes)
        if package == OWN_PACKAGE:
            parts.append(example(verb, is_step=True))
    parts += part_sections(STEPS.values())
    return "\n\n".join(parts) + "\n"


def contents(words: Iterable[str]) -> str:
    """Links to the sections."""
    return " · ".join(f"[`{word}`](#{word})" for word in words)


def section(
    word: str, model: type[SpecModel], shared: Collection[str], notes: Iterable[str]
) -> list[str]:
    """A word's heading, definition, notes and keys."""
    fields = [(key, field) for key, field in keys_of(model).items() if key not in shared]
    parts = [f"## `{word}`", description_of(model), *notes]
    if model.short and not any(f.is_required() for key, f in fields if key != model.short):
        parts.append(f"`- {word}: x` is short for `- {word}: {{{model.short}: x}}`.")
    if fields:
        parts.append(table(fields))
    return parts


def part_sections(models: Iterable[type[SpecModel]]) -> list[str]:
    """Sections of the models that the keys of these models hold, in alphabetical order."""
    found: dict[str, type[SpecModel]] = {}
    waiting = list(models)
    while waiting:
        for field in keys_of(waiting.pop()).values():
            for part in _models_in(field.annotation):
                if part.__name__ not in found:
                    found[part.__name__] = part
                    waiting.append(part)
    lines = ["## Parts"] if found else []
    for name in sorted(found):
        fields = keys_of(found[name]).items()
        lines += [f"### {name}", description_of(found[name]), *([table(fields)] if fields else [])]
    return lines


def _models_in(annotation: Any) -> list[type[SpecModel]]:
    """The models that are no step and no expectation, anywhere in an annotation."""
    annotation = plugin_model(annotation) or annotation
    if is_model(annotation):
        is_word = issubclass(annotation, StepFields | ExpectationFields)
        return [] if is_word else [annotation]
    return [model for each in get_args(annotation) for model in _models_in(each)]


def table(fields: Iterable[tuple[str, FieldInfo]]) -> str:
    """Keys with what may be written, their default and meaning."""
    rows = ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
    for key, field in fields:
        cells = (f"`{key}`", _kind(field), _default(field), field.description or "")
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows)


def words(meanings: Mapping[str, str]) -> str:
    """A list of words."""
    return "\n".join(f"- `{word}`: {meaning}" for word, meaning in meanings.items())


def _kind(field: FieldInfo) -> str:
    return _described(field.annotation, tuple(field.metadata))


def _described(annotation: Any, metadata: tuple[Any, ...] = ()) -> str:
    """What may be written, in words: `length [m]`, `list of text`, a model's keys."""
    while get_origin(annotation) is Annotated:
        model = plugin_model(annotation)
        annotation, *more = get_args(annotation)
        annotation, metadata = model or annotation, (*more, *metadata)
    for item in metadata:
        function = item.func if isinstance(item, BeforeValidator) else None
        units, said = getattr(function, "units", None), getattr(function, "words", None)
        if said is not None:
            return said
        if units == SHARE:
            return f"{MEANINGS['1'][0]} (`0.5`, `50 %`)"
        if units is not None:
            return " or ".join(f"{MEANINGS[unit][0]} [{unit}]" for unit in units)
    if annotation is StepFields:
        return "step"
    if annotation is ExpectationFields:
        return "expectation"
    arguments = get_args(annotation)
    if get_origin(annotation) in (Union, types.UnionType):
        kinds = [_described(each) for each in arguments if each is not type(None)]
        return " or ".join(dict.fromkeys(kinds))
    if get_origin(annotation) is Literal:
        if set(arguments) <= set(get_args(ErrorCode)):
            return "error code"
        return ", ".join(f"`{each}`" for each in arguments)
    if get_origin(annotation) in (tuple, list):
        first = _described(arguments[0])
        size = "" if arguments[-1] is ... or len(arguments) == 1 else f"{len(arguments)} x "
        return f"list of {size}{first}"
    if get_origin(annotation) is dict:
        return f"mapping of name to {_described(arguments[1])}"
    if is_model(annotation):
        return f"[{annotation.__name__}](#{annotation.__name__.lower()})"
    return KINDS.get(annotation, "any value")


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value in (None, "", (), {}) or isinstance(value, SpecModel):
        return ""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`[{', '.join(map(_short, cast('tuple[Any, ...]', value)))}]`"
    return f"`{_short(value)}`"


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)
