"""Results as one JSON document for machines."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from typing import Any, cast

from pydantic_core import to_json

from harness.core.printable import json_printable


def json_text(document: object) -> str:
    r"""Strict JSON: dataclasses as objects, numbers that are not finite as null.

    Controls and signs that turn the direction of text are `\\u` escapes.
    """
    try:
        text = to_json(document, indent=2, inf_nan_mode="null").decode()
    except (ValueError, TypeError):  # values that pydantic refuses, such as lone surrogates
        text = json.dumps(_plain(document), indent=2, ensure_ascii=False, allow_nan=False)
    return f"{json_printable(text)}\n"


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
