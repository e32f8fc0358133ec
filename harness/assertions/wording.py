"""An expectation in one line: `never: collision between robot and Table`."""

from __future__ import annotations

from typing import Any, cast

from pydantic import BaseModel

from harness.assertions.text import amount
from harness.spec.checks import AnyExpectation

UNITS = {
    "above": "m",
    "at_most": "s",
    "max_slip": "m",
    "max_distance": "m",
    "max_deviation": "m",
    "max_rotation": "rad",
    "max_velocity": "m/s",
    "max_angular_velocity": "rad/s",
    "min_force": "N",
    "width": "m",
    "for_": "s",
    "within": "s",
}
"""Of numbers whose key alone gives them; `at_least` depends on the predicate."""
AT_LEAST = {"clearance": "m", "displaced": "m", "duration": "s", "path_length": "m"}
SUBJECTS = ("object", "state", "named_target", "between", "formula")
SILENT = ("check", "points", "name", "predicate", "until", *SUBJECTS)


def describe(spec: AnyExpectation) -> str:
    """What is expected, in the file's words, with everything that the file says about it."""
    text = _described(spec)
    name = getattr(spec, "name", None)
    return f"{name} ({text})" if name else text


def _described(spec: BaseModel) -> str:
    check = str(getattr(spec, "check", ""))
    inner = getattr(spec, "predicate", None)
    if isinstance(inner, BaseModel):
        text = f"{check}: {_described(inner)}"
        other = getattr(spec, "until", None)
        if isinstance(other, BaseModel):
            text += f" until {_described(other)}"
    else:
        text = " ".join([check, *_subjects(spec)])
    said = [
        f"{_key(key)} {_value(check, key, getattr(spec, key))}"
        for key in type(spec).model_fields
        if key in spec.model_fields_set and key not in SILENT and getattr(spec, key) is not None
    ]
    return ", ".join([text, *said])


def _subjects(spec: BaseModel) -> list[str]:
    words: list[str] = []
    for key in SUBJECTS:
        value = getattr(spec, key, None)
        if key == "between" and value:
            words.append(f"between {value[0]} and {value[1]}")
        elif value:
            words.append(str(value))
    return words


def _key(key: str) -> str:
    return key.rstrip("_").replace("_", " ")


def _value(check: str, key: str, value: Any) -> str:
    if isinstance(value, BaseModel):
        return _fields(value)
    if isinstance(value, dict):
        positions = cast("dict[str, float]", value)
        return ", ".join(f"{name}={item:.6g}" for name, item in positions.items())
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        unit = AT_LEAST.get(check, "1") if key == "at_least" else UNITS.get(key, "")
        if key == "at_most":
            unit = AT_LEAST.get(check, "s")
        return amount(value, unit) if unit else f"{value:.6g}"
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
