"""Results as one JSON document for machines."""

from __future__ import annotations

import json
from typing import Any, cast

from harness.core.printable import json_printable
from harness.recording.plain import NotFinite, to_plain

WIDTH = 120  # columns that a row of a document may have


def json_text(document: object) -> str:
    r"""Strict JSON: dataclasses as objects, numbers that are not finite as null.

    What fits in a row stands in one, so that a pose or a point is a line. Controls and signs that
    turn the direction of text are `\\u` escapes.
    """
    plain = to_plain(document, not_finite="null")
    return f"{json_printable(_laid_out(plain, WIDTH, is_whole=True))}\n"


def _laid_out(value: Any, width: int, *, is_whole: bool = False) -> str:
    """JSON in one row of this width, or with a row for each entry."""
    match value:
        case dict():
            entries = cast("dict[str, Any]", value).items()
            keys = [json.dumps(key, ensure_ascii=False) for key, _ in entries]
            parts = [
                f"{key}: {_laid_out(each, width - len(key) - 4)}"
                for key, (_, each) in zip(keys, entries, strict=True)
            ]
            begin, end = "{}"
        case list():
            parts = [_laid_out(each, width - 2) for each in cast("list[Any]", value)]
            begin, end = "[]"
        case _:
            return json.dumps(value, ensure_ascii=False, allow_nan=False)
    row = f"{begin}{', '.join(parts)}{end}"
    if not parts or (len(row) <= width and "\n" not in row and not is_whole):
        return row
    rows = ",\n".join(parts).replace("\n", "\n  ")
    return f"{begin}\n  {rows}\n{end}"


def compact_json(value: object, *, not_finite: NotFinite = "null") -> str:
    """A value as one line of strict JSON.

    Args:
        not_finite: Whether numbers that are not finite are null, or strings such as `NaN`.
    """
    plain = to_plain(value, not_finite=not_finite)
    text = json.dumps(plain, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return json_printable(text)
