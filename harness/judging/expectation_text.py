"""An expectation in one line: `never: collision between robot and Table`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

from pydantic import BaseModel

from harness.judging.expectation import Expectation, Predicate
from harness.judging.text import amount
from harness.language.annotations import units_of
from harness.language.expectation import ExpectationFields

OMITTED = ("points", "name")


def describe(spec: ExpectationFields) -> str:
    """What is expected, in the file's words, with everything that the file says about it."""
    text = _described(spec)
    return f"{spec.name} ({text})" if spec.name else text


def _described(spec: ExpectationFields) -> str:
    inside = spec.predicates() if isinstance(spec, Expectation) else None
    predicates: Mapping[str, Predicate] = inside or {}
    subject = spec.subject_field()
    text = spec.word
    if predicates:
        first, *others = predicates.items()
        text += f": {_described(first[1])}"
        text += "".join(f" {key} {_described(inner)}" for key, inner in others)
    elif subject and getattr(spec, subject) is not None:
        text += f" {_subject(subject, getattr(spec, subject))}"
    parts = [
        f"{_key(key)} {_value(spec, key)}"
        for key in type(spec).model_fields
        if key in spec.model_fields_set
        and key not in (*OMITTED, *predicates, subject)
        and getattr(spec, key) is not None
    ]
    return ", ".join([text, *parts])


def _subject(key: str, value: Any) -> str:
    if isinstance(value, tuple):
        return f"{_key(key)} {' and '.join(map(str, cast('tuple[Any, ...]', value)))}"
    return str(value)


def _key(key: str) -> str:
    return key.rstrip("_").replace("_", " ")


def _value(spec: ExpectationFields, key: str) -> str:
    """A field's value with the unit of the field; without one where it depends on the joint."""
    value = getattr(spec, key)
    if isinstance(value, BaseModel):
        return _fields(value)
    if isinstance(value, dict):
        positions = cast("dict[str, float]", value)
        return ", ".join(f"{name}={item:.6g}" for name, item in positions.items())
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        field = type(spec).model_fields[key]
        units = units_of(field.annotation, field.metadata)
        has_unit = len(units) == 1 and units != ("1",)
        return amount(value, units[0]) if has_unit else f"{value:.6g}"
    return str(value)


def _fields(model: BaseModel) -> str:
    parts = [
        f"{key} {_vector(value)}"
        for key in type(model).model_fields
        if (value := getattr(model, key)) is not None
    ]
    return "(" + ", ".join(parts) + ")"


def _vector(value: Any) -> str:
    if isinstance(value, BaseModel):
        return _fields(value)
    if isinstance(value, tuple):
        return "[" + ", ".join(f"{part:.6g}" for part in value) + "]"  # pyright: ignore[reportUnknownVariableType]
    return f"{value:.6g}" if isinstance(value, float) else str(value)
