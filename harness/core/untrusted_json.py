"""Reads JSON of files and messages that anybody may have written."""

from __future__ import annotations

import json
from typing import Any


def parse_json(text: str | bytes) -> Any:
    """The document of a text.

    Raises:
        ValueError: The text is no JSON; or lists or mappings are nested too deeply, which Python's
            reader reports as a RecursionError.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("lists or mappings are nested too deeply") from None
