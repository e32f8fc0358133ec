"""Records to plain data that JSON can carry, and back by their types.

Floats that JSON lacks are the strings `NaN`, `Infinity` and `-Infinity`, everywhere.
"""

from __future__ import annotations

import json
import math
import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any, Literal, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from harness.core.details import Details
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Sphere
from harness.core.spatial import SE3

NotFinite = Literal["null", "strings"]
GEOMETRIES = {kind.__name__.lower(): kind for kind in (Box, Capsule, Cylinder, Mesh, Plane, Sphere)}
NOT_NUMBERS = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
SCALARS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}
QUOTED = 60  # Characters of a value that an error quotes


def to_plain(value: Any, *, not_finite: NotFinite = "strings") -> Any:
    """Dictionaries, lists, strings and numbers for any record.

    Args:
        not_finite: Whether numbers that are not finite are null, or strings such as `NaN`.

    Raises:
        TypeError: Something has no plain form.
    """
    plain = partial(to_plain, not_finite=not_finite)
    match value:
        case None | str() | bool() | int():
            return value
        case float():
            return _plain_float(value, not_finite)
        case np.generic():
            return plain(value.item())
        case np.ndarray():
            return plain(cast("Any", value).tolist())
        case SE3():
            return {"rotation": plain(value.rotation), "xyz": plain(value.translation)}
        case Path():
            return str(value)
        case Mapping():
            mapping = cast("Mapping[Any, Any]", value)
            if any(isinstance(key, tuple) for key in mapping):
                return [[plain(key), plain(item)] for key, item in mapping.items()]
            return {str(key): plain(item) for key, item in mapping.items()}
        case list() | tuple():
            return [plain(item) for item in cast("list[Any]", value)]
        case set() | frozenset():
            return [plain(item) for item in sorted(cast("set[Any]", value))]
        case Details():
            return plain(value.plain())
        case _ if is_dataclass(value):
            content = {entry.name: plain(getattr(value, entry.name)) for entry in fields(value)}
            kind = type(value).__name__.lower()
            return {"kind": kind, **content} if kind in GEOMETRIES else content
        case _:
            raise TypeError(f"{type(value).__name__} has no plain form: {value!r}")


class PlainError(ValueError):
    """Plain data does not fit its type.

    Attributes:
        key: Where it is: `robot.joints[2].lower`; empty for the whole.
        expected: What should stand there.
    """

    def __init__(self, key: str, expected: str) -> None:
        self.key, self.expected = key, expected
        super().__init__(f"{key}: {expected}" if key else expected)


def from_plain(plain: Any, kind: Any, key: str = "") -> Any:
    """A value of a type from its plain form; unknown keys are left out, defaults fill in.

    Raises:
        PlainError: The data does not fit the type.
    """
    if kind is Any:
        return _any(plain)
    if kind in (float, int, bool, str):
        return _scalar(plain, kind, key)
    if kind is SE3:
        return _pose(plain, key)
    if kind is Path:
        return Path(_scalar(plain, str, key))
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Literal:
        if plain not in arguments:
            raise PlainError(
                key, f"expected one of {', '.join(map(str, arguments))}, found {_short(plain)}"
            )
        return plain
    if origin in (Union, types.UnionType):
        return _one_of(plain, arguments, key)
    if origin is tuple:
        return _tuple(plain, arguments, key)
    if origin is frozenset:
        return frozenset(_tuple(plain, (*arguments, ...), key))
    if origin is np.ndarray:
        return _array(plain, key)
    if origin is not None and issubclass(origin, Mapping):
        if get_origin(arguments[0]) is tuple:
            return dict(_tuple(plain or [], (tuple[arguments], ...), key))
        return {
            name: from_plain(item, arguments[1], f"{key}.{name}")
            for name, item in _mapping(plain, key).items()
        }
    return _record(plain, kind, key)


def _scalar(plain: Any, kind: type, key: str) -> Any:
    if kind is float and isinstance(plain, str) and plain in NOT_NUMBERS:
        return NOT_NUMBERS[plain]
    accepted = (int, float) if kind is float else kind
    if not isinstance(plain, accepted) or (isinstance(plain, bool) and kind is not bool):
        raise PlainError(key, f"expected {SCALARS[kind]}, found {_short(plain)}")
    try:
        return kind(plain)
    except OverflowError:
        raise PlainError(key, f"the number {_short(plain)} is too large") from None


def _array(plain: Any, key: str) -> np.ndarray[Any, Any]:
    """An array of floats from lists of one length at each depth, or from one number."""
    if not isinstance(plain, list):
        return np.array(_scalar(plain, float, key))
    rows = [_array(each, f"{key}[{n}]") for n, each in enumerate(cast("list[Any]", plain))]
    if len({row.shape for row in rows}) > 1:
        raise PlainError(key, "expected lists of one length")
    return np.array(rows, dtype=float)


def _pose(plain: Any, key: str) -> SE3:
    document = _mapping(plain, key)
    row = tuple[float, float, float]
    rotation = from_plain(document.get("rotation"), tuple[row, row, row], f"{key}.rotation")
    return SE3(np.array(rotation), np.array(from_plain(document.get("xyz"), row, f"{key}.xyz")))


def _tuple(plain: Any, kinds: tuple[Any, ...], key: str) -> tuple[Any, ...]:
    if not isinstance(plain, list | tuple):
        raise PlainError(key, f"expected a list, found {_short(plain)}")
    items = cast("list[Any]", plain)
    if kinds[1:] == (...,):
        kinds = kinds[:1] * len(items)
    if len(items) != len(kinds):
        raise PlainError(key, f"expected {len(kinds)} items, found {len(items)}")
    return tuple(
        from_plain(item, kind, f"{key}[{index}]")
        for index, (item, kind) in enumerate(zip(items, kinds, strict=True))
    )


def _record(plain: Any, kind: type, key: str) -> Any:
    document, hints = _mapping(plain, key), _hints(kind)
    for entry in fields(kind):
        has_default = entry.default is not MISSING or entry.default_factory is not MISSING
        if entry.name not in document and not has_default:
            raise PlainError(f"{key}.{entry.name}".lstrip("."), "this key is missing")
    return kind(
        **{
            name: from_plain(document[name], hint, f"{key}.{name}".lstrip("."))
            for name, hint in hints.items()
            if name in document
        }
    )


def _mapping(plain: Any, key: str) -> dict[str, Any]:
    if not isinstance(plain, dict):
        raise PlainError(key, f"expected a mapping, found {_short(plain)}")
    return cast("dict[str, Any]", plain)


def _short(plain: Any) -> str:
    """A value as an error quotes it."""
    match plain:
        case dict():
            return "a mapping"
        case list():
            return "a list"
        case _:
            text = json.dumps(plain)
            return text if len(text) <= QUOTED else f"{text[:QUOTED]}..."


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _one_of(plain: Any, kinds: tuple[Any, ...], key: str) -> Any:
    """One of the geometries, by its `kind`, or a value that may be None."""
    if plain is None and type(None) in kinds:
        return None
    others = [kind for kind in kinds if kind is not type(None)]
    if len(others) == 1:
        return from_plain(plain, others[0], key)
    name = _mapping(plain, key).get("kind")
    if not isinstance(name, str) or name not in GEOMETRIES:
        known = ", ".join(GEOMETRIES)
        raise PlainError(f"{key}.kind", f"expected one of {known}, found {_short(name)}")
    return _record(plain, GEOMETRIES[name], key)


def _plain_float(value: float, not_finite: NotFinite) -> float | str | None:
    if math.isfinite(value):
        return value
    if not_finite == "null":
        return None
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
