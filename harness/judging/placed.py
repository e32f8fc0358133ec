"""An expectation of a file: its place, its check, and its text in one line."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, cast

from pydantic import BaseModel

from harness.cell.scope import At, Scope
from harness.core.amounts import JointUnits, amount_in_units
from harness.judging.expectation import Expectation, Mechanisms, Predicate
from harness.language.annotations import unit_of, units_of
from harness.language.expectation import ExpectationFields
from harness.language.files.source import Loc
from harness.language.poses import Pose, PoseTolerance, Position

JOINT_UNITS = ("rad", "m")  # of `JointValue`
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
        """An expectation of a file with its place."""
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


def describe(spec: ExpectationFields, mechanisms: Mechanisms | None = None) -> str:
    """An expectation as a sentence: `never: collision between robot and Table`, `box is in bin`.

    What has its default value is left out.

    Args:
        mechanisms: What gives the positions of joints their units; without it they have none.
    """
    text = _Sentences(mechanisms).described(spec)
    return f"{spec.name} ({text})" if spec.name else text


@dataclass(frozen=True, eq=False)
class _Sentences:
    """Writes expectations as sentences."""

    mechanisms: Mechanisms | None

    def described(self, spec: ExpectationFields) -> str:
        """An expectation without its name for people."""
        inside = spec.predicates() if isinstance(spec, Expectation) else None
        predicates: Mapping[str, Predicate] = inside or {}
        said = {*OMITTED, *predicates}
        if predicates:
            (_, first), *more = predicates.items()
            text = self.described(first)
            text = text if more else f"{spec.word}: {text}"
            text += "".join(f" {key} {self.described(inner)}" for key, inner in more)
        elif spec.sentence:
            text = self._filled(spec, spec.sentence)
            said.update(FIELD.findall(spec.sentence))
        else:
            subject = spec.subject_field()
            text = spec.word
            if subject and getattr(spec, subject) is not None:
                pair = f"{_key(subject)} " if isinstance(getattr(spec, subject), tuple) else ""
                text += f" {pair}{self._value(spec, subject)}"
            said.add(subject)
        stated = [key for key in type(spec).model_fields if key not in said]
        return ", ".join(
            [text, *(self._part(spec, key) for key in stated if _is_stated(spec, key))]
        )

    def _part(self, model: BaseModel, key: str) -> str:
        """A field with its key, which a flag has in its value."""
        word = "" if isinstance(getattr(model, key), bool) else f"{_key(key)} "
        return word + self._value(model, key)

    def _filled(self, spec: ExpectationFields, template: str) -> str:
        """A sentence with the values of fields; of its parts `[text|other]` those that apply."""
        text, last, is_joined = "", 0, False
        for found in OPTIONAL.finditer(template):
            between = template[last : found.start()]
            stated, _, other = found[1].partition("|")
            is_stated = any(_is_stated(spec, key) for key in FIELD.findall(stated))
            is_joined = is_joined and not between
            text += between + (" and" * is_joined + stated if is_stated else other)
            last, is_joined = found.end(), is_joined or is_stated
        return FIELD.sub(lambda each: self._value(spec, each[1]), text + template[last:])

    def _value(self, model: BaseModel, key: str) -> str:
        """A field's value with its unit; a flag as words."""
        value = getattr(model, key)
        match value:
            case Pose() | Position():
                return value.text()
            case PoseTolerance():
                stated = [each for each in type(value).model_fields if _is_stated(value, each)]
                return " and ".join(self._value(value, each) for each in stated)
            case BaseModel():
                return self._fields(value)
            case dict():
                return self._positions(cast("dict[str, float]", value))
            case tuple():
                parts = cast("tuple[Any, ...]", value)
                is_text = any(isinstance(part, str) for part in parts)
                return " and ".join(parts) if is_text else f"({', '.join(map(_number, parts))})"
            case bool():
                return _key(key) if value else f"not {_key(key)}"
            case float():
                return amount_in_units(value, self._units(model, key)) or _number(value)
            case _:
                return str(value)

    def _positions(self, positions: Mapping[str, float]) -> str:
        known = self.mechanisms
        units = JointUnits() if known is None else known.robot.joint_units
        return ", ".join(f"{name}={units.text({name: at})}" for name, at in positions.items())

    def _units(self, model: BaseModel, key: str) -> Collection[str]:
        """The unit of a field, of a joint's value those of its joints; none where it has none."""
        is_word = isinstance(model, ExpectationFields)
        if unit := model.unit_of(key) if is_word else unit_of(model, key):
            return (unit,)
        field = type(model).model_fields[key]
        if self.mechanisms is None or not isinstance(model, Expectation):
            return ()
        is_of_joints = units_of(field.annotation, field.metadata) == JOINT_UNITS
        return model.joint_units(self.mechanisms) if is_of_joints else ()

    def _fields(self, model: BaseModel) -> str:
        """The fields of a model that differ from their defaults; of the short one its value."""
        stated = [key for key in type(model).model_fields if _is_stated(model, key)]
        if stated == [getattr(model, "short", "")]:
            return self._value(model, stated[0])
        return f"({', '.join(f'{_key(key)} {self._value(model, key)}' for key in stated)})"


def _is_stated(model: BaseModel, key: str) -> bool:
    """Whether a field says more than its absence."""
    value = getattr(model, key)
    return value is not None and value != type(model).model_fields[key].default


def _key(key: str) -> str:
    return key.rstrip("_").replace("_", " ")


def _number(value: float) -> str:
    return f"{value:.6g}"
