"""An expectation of a file: its place, its check, and its text in one line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

from pydantic import BaseModel

from harness.cell.scope import At, Scope
from harness.core.amounts import amount
from harness.judging.expectation import Expectation, Predicate
from harness.language.annotations import unit_of
from harness.language.expectation import ExpectationFields
from harness.language.files.source import Loc
from harness.language.poses import Pose, PoseTolerance, Position

OMITTED = ("points", "name")  # keys that are no part of an expectation's text
FIELD = re.compile(r"\{(\w+)\}")
OPTIONAL = re.compile(r"\[([^\[\]]*)\]")


@dataclass(frozen=True)
class PlacedExpectation:
    """An expectation, the step that it is judged over, and its place in the file.

    Attributes:
        step: Id (or path) of the step it stands on; empty for the whole run.
        line: The line in the scenario file, from 1; 0 if unknown.
    """

    spec: Expectation
    step: str = ""
    line: int = 0

    @classmethod
    def of(cls, spec: ExpectationFields, step: str, line: int) -> PlacedExpectation:
        """An expectation of a file with its place.

        Raises:
            TypeError: The class of its word is no expectation.
        """
        return cls(as_expectation(spec), step, line)


def as_expectation(spec: ExpectationFields) -> Expectation:
    """A file's expectation as what can be checked and judged.

    Raises:
        TypeError: The class of its word is no expectation.
    """
    if not isinstance(spec, Expectation):
        raise TypeError(f"{type(spec).__name__} is no subclass of Expectation")
    return spec


def check_expectation(spec: Expectation, loc: Loc, scope: Scope, step: str = "") -> None:
    """Report what is wrong with an expectation; names may be of steps and objects further down.

    Args:
        spec: The expectation to be checked.
        loc: Its place in the file.
        scope: Every name of the file.
        step: The id of the step under which it stands; empty for the whole run.
    """
    if spec.during is not None and spec.during not in scope.step_ids:
        scope.problems.unknown(
            (*loc, "during"), "step with the id", spec.during, scope.step_ids, needs=()
        )
    if loc[0] == "expect" and len(loc) == 2:
        _check_step_is_named(spec, loc, scope)
    for key, inner in spec.predicates().items():
        check_expectation(inner, (*loc, key), scope, spec.during or step)
    arm = scope.arm_of(spec.stated_arm(), None, loc, "by")
    if spec.stated_arm() is None:
        arm = scope.step_ids.get(spec.during or step, "") or arm
    with scope.with_arm(arm, "by"):
        spec.check(At(scope, loc))


def _check_step_is_named(spec: Expectation, loc: Loc, scope: Scope) -> None:
    """Report an expectation of the whole run that can be judged only over a step."""
    parts = (spec, *spec.predicates().values())
    why = next((part.needs_step() for part in parts if part.needs_step()), "")
    if why and not any(part.during for part in parts):
        scope.problems.add(
            loc,
            f"{why}; this is expected of the whole run",
            "write it under the step's `expect`, or name the step with `during`",
        )


def describe(spec: ExpectationFields) -> str:
    """An expectation as a sentence: `never: collision between robot and Table`, `box is in bin`.

    What has its default value is left out.
    """
    text = _described(spec)
    return f"{spec.name} ({text})" if spec.name else text


def _described(spec: ExpectationFields) -> str:
    inside = spec.predicates() if isinstance(spec, Expectation) else None
    predicates: Mapping[str, Predicate] = inside or {}
    said = {*OMITTED, *predicates}
    if predicates:
        first, *others = predicates.items()
        text = _described(first[1]) if others else f"{spec.word}: {_described(first[1])}"
        text += "".join(f" {key} {_described(inner)}" for key, inner in others)
    elif spec.sentence:
        text = _filled(spec, spec.sentence)
        said.update(FIELD.findall(spec.sentence))
    else:
        subject = spec.subject_field()
        text = spec.word
        if subject and getattr(spec, subject) is not None:
            pair = f"{_key(subject)} " if isinstance(getattr(spec, subject), tuple) else ""
            text += f" {pair}{_value(spec, subject)}"
        said.add(subject)
    parts = [
        ("" if isinstance(getattr(spec, key), bool) else f"{_key(key)} ") + _value(spec, key)
        for key in type(spec).model_fields
        if key not in said and _is_stated(spec, key)
    ]
    return ", ".join([text, *parts])


def _filled(spec: ExpectationFields, template: str) -> str:
    """A sentence with the values of fields; of its parts `[text|other]` those that apply."""
    text, last, is_joined = "", 0, False
    for found in OPTIONAL.finditer(template):
        between = template[last : found.start()]
        stated, _, other = found[1].partition("|")
        is_stated = any(_is_stated(spec, key) for key in FIELD.findall(stated))
        is_joined = is_joined and not between
        text += between + (" and" * is_joined + stated if is_stated else other)
        last, is_joined = found.end(), is_joined or is_stated
    return FIELD.sub(lambda each: _value(spec, each[1]), text + template[last:])


def _is_stated(model: BaseModel, key: str) -> bool:
    """Whether a field says more than its absence."""
    value = getattr(model, key)
    return value is not None and value != type(model).model_fields[key].default


def _key(key: str) -> str:
    return key.rstrip("_").replace("_", " ")


def _value(model: BaseModel, key: str) -> str:
    """A field's value with its unit; without one where it depends on the joint; a flag as words."""
    value = getattr(model, key)
    match value:
        case Pose() | Position():
            return value.text()
        case PoseTolerance():
            stated = [each for each in type(value).model_fields if _is_stated(value, each)]
            return " and ".join(_value(value, each) for each in stated)
        case BaseModel():
            return _fields(value)
        case dict():
            positions = cast("dict[str, float]", value)
            return ", ".join(f"{name}={item:.6g}" for name, item in positions.items())
        case tuple():
            parts = cast("tuple[Any, ...]", value)
            is_text = any(isinstance(part, str) for part in parts)
            return " and ".join(parts) if is_text else f"({', '.join(map(_number, parts))})"
        case bool():
            return _key(key) if value else f"not {_key(key)}"
        case float():
            unit = (
                model.unit_of(key) if isinstance(model, ExpectationFields) else unit_of(model, key)
            )
            return amount(value, unit) if unit else _number(value)
        case _:
            return str(value)


def _number(value: float) -> str:
    return f"{value:.6g}"


def _fields(model: BaseModel) -> str:
    """The fields of a model that differ from their defaults; of the short one alone, its value."""
    stated = [key for key in type(model).model_fields if _is_stated(model, key)]
    if stated == [getattr(model, "short", "")]:
        return _value(model, stated[0])
    return "(" + ", ".join(f"{_key(key)} {_value(model, key)}" for key in stated) + ")"
