"""Results as one JSON document for machines."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from typing import Any, Literal, cast

from pydantic_core import to_json

from harness.core.printable import json_printable
from harness.recording.plain import to_plain

NotFinite = Literal["null", "strings"]


def json_text(document: object) -> str:
    r"""Strict JSON: dataclasses as objects, numbers that are not finite as null.

    Controls and signs that turn the direction of text are `\\u` escapes.
    """
    try:
        text = to_json(document, indent=2, inf_nan_mode="null").decode()
    except (ValueError, TypeError):  # values that pydantic refuses, such as lone surrogates
        text = json.dumps(_plain(document), indent=2, ensure_ascii=False, allow_nan=False)
    return f"{json_printable(text)}\n"


def compact_json(value: object, *, not_finite: NotFinite = "null") -> str:
    """A value as one line of strict JSON.

    Args:
        value: Plain data and dataclasses.
        not_finite: Whether numbers that are not finite are null, or strings such as `NaN`.
    """
    try:
        text = to_json(value, inf_nan_mode=not_finite).decode()
    except (ValueError, TypeError):  # values that pydantic refuses, such as lone surrogates
        plain = _plain(value) if not_finite == "null" else to_plain(value)
        text = json.dumps(plain, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return json_printable(text)


def _plain(value: object) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {each.name: _plain(getattr(value, each.name)) for each in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        items = cast("Mapping[object, object]", value).items()
        return {str(key): _plain(item) for key, item in items}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in cast("list[object]", value)]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
