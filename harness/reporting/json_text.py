"""Results as one JSON document for machines."""

from __future__ import annotations

import json

from harness.core.printable import json_printable
from harness.recording.plain import NotFinite, to_plain


def json_text(document: object) -> str:
    r"""Strict JSON: dataclasses as objects, numbers that are not finite as null.

    Controls and signs that turn the direction of text are `\\u` escapes.
    """
    plain = to_plain(document, not_finite="null")
    text = json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False)
    return f"{json_printable(text)}\n"


def compact_json(value: object, *, not_finite: NotFinite = "null") -> str:
    """A value as one line of strict JSON.

    Args:
        value: Plain data and dataclasses.
        not_finite: Whether numbers that are not finite are null, or strings such as `NaN`.
    """
    plain = to_plain(value, not_finite=not_finite)
    text = json.dumps(plain, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return json_printable(text)
