"""Results as one JSON document for machines."""

from __future__ import annotations

import json

from pydantic_core import to_json

from harness.core.printable import json_printable
from harness.recording.plain import NotFinite, to_plain


def json_text(document: object) -> str:
    r"""Strict JSON: dataclasses as objects, numbers that are not finite as null.

    Controls and signs that turn the direction of text are `\\u` escapes.
    """
    return f"{_strict_json(document, 'null', 2)}\n"


def compact_json(value: object, *, not_finite: NotFinite = "null") -> str:
    """A value as one line of strict JSON.

    Args:
        not_finite: Whether numbers that are not finite are null, or strings such as `NaN`.
    """
    return _strict_json(value, not_finite, None)


def _strict_json(value: object, not_finite: NotFinite, indent: int | None) -> str:
    try:
        text = to_json(value, indent=indent, inf_nan_mode=not_finite).decode()
    except (ValueError, TypeError):  # values that pydantic refuses, such as lone surrogates
        plain, separators = to_plain(value, not_finite=not_finite), None if indent else (",", ":")
        text = json.dumps(
            plain, indent=indent, separators=separators, ensure_ascii=False, allow_nan=False
        )
    return json_printable(text)
