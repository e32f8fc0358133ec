"""Records to plain data that JSON can carry, and back by their types.

Floats that JSON lacks are the strings `NaN`, `Infinity` and `-Infinity`, everywhere.
"""

from __future__ import annotations

import math
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Sphere
from harness.core.spatial import SE3

GEOMETRIES = {kind.__name__.lower(): kind for kind in (Box, Capsule, Cylinder, Mesh, Plane, Sphere)}
NOT_NUMBERS = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}


def to_plain(value: Any) -> Any:
    """Dictionaries, lists, strings and numbers for any record.

    Raises:
        TypeError: Something has no plain form.
    """
    match value:
        case None | str() | bool() | int():
            return value
        case float():
            return _plain_float(value)
        case np.generic():
            return to_plain(value.item())
        case np.ndarray():
            return to_plain(cast("Any", value).tolist())
        case SE3():
            return {"rotation": to_plain(value.rotation), "xyz": to_plain(value.translation)}
        case Path():
            return str(value)
        case Mapping():
            mapping = cast("Mapping[Any, Any]", value)
            return {str(key): to_plain(item) for key, item in mapping.items()}
        case list() | tuple():
            return [to_plain(item) for item in cast("list[Any]", value)]
        case set() | frozenset():
            return [to_plain(item) for item in sorted(cast("set[Any]", value))]
        case _ if is_dataclass(value):
            plain = {entry.name: to_plain(getattr(value, entry.name)) for entry in fields(value)}
            kind = type(value).__name__.lower()
            return {"kind": kind, **plain} if kind in GEOMETRIES else plain
        case _:
            raise TypeError(f"{type(value).__name__} has no plain form: {value!r}")


def from_plain(plain: Any, kind: Any) -> Any:
    """A value of a type from its plain form; unknown keys are left out, defaults fill in.

    Raises:
        TypeError, ValueError, KeyError: The data does not fit the type.
    """
    if kind is Any:
        return _any(plain)
    if kind is float:
        return NOT_NUMBERS[plain] if isinstance(plain, str) else float(plain)
    if kind is SE3:
        rotation = np.array(_any(plain["rotation"]), dtype=float)
        return SE3(rotation, np.array(_any(plain["xyz"]), dtype=float))
    if kind is Path:
        return Path(plain)
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Literal:
        if plain not in arguments:
            raise ValueError(f"{plain!r} is none of {arguments}")
        return plain
    if origin in (Union, types.UnionType):
        return _one_of(plain, arguments)
    if origin is tuple:
        items = arguments[:1] * len(plain) if arguments[1:] == (...,) else arguments
        return tuple(from_plain(item, each) for item, each in zip(plain, items, strict=True))
    if origin is not None and issubclass(origin, Mapping):
        return {key: from_plain(item, arguments[1]) for key, item in plain.items()}
    if is_dataclass(kind):
        hints = _hints(cast("type", kind))
        return cast("type", kind)(
            **{name: from_plain(plain[name], hint) for name, hint in hints.items() if name in plain}
        )
    if not isinstance(plain, kind):
        raise TypeError(f"{plain!r} is no {kind.__name__}")
    return plain


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _one_of(plain: Any, kinds: tuple[Any, ...]) -> Any:
    if plain is None and type(None) in kinds:
        return None
    if isinstance(plain, dict) and "kind" in plain:
        return from_plain(plain, GEOMETRIES[cast("dict[str, str]", plain)["kind"]])
    (kind,) = (kind for kind in kinds if kind is not type(None))
    return from_plain(plain, kind)


def _plain_float(value: float) -> float | str:
    if math.isfinite(value):
        return value
    return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")


def _any(plain: Any) -> Any:
    match plain:
        case dict():
            return {key: _any(item) for key, item in cast("dict[str, Any]", plain).items()}
        case list():
            return [_any(item) for item in cast("list[Any]", plain)]
        case str() if plain in NOT_NUMBERS:
            return NOT_NUMBERS[plain]
        case _:
            return plain
