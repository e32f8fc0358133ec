"""Reads JSON of files and messages that anybody may have written."""

from __future__ import annotations

import json
from contextlib import nullcontext
from typing import Any

from harness.core.limits import MB, READING_MEMORY
from harness.core.memory import limited_memory

LARGE = 10 * MB  # a smaller text takes at most a quarter of READING_MEMORY


def parse_json(text: str | bytes) -> Any:
    """The document of a text.

    Raises:
        ValueError: The text is no JSON, or takes too much memory; or lists or mappings are nested
            too deeply, which Python's reader reports as a RecursionError.
    """
    try:
        with limited_memory(READING_MEMORY) if len(text) > LARGE else nullcontext():
            return json.loads(text)
    except MemoryError:
        raise ValueError(f"it takes more than {READING_MEMORY / 1e9:g} GB to read") from None
    except RecursionError:
        raise ValueError("lists or mappings are nested too deeply") from None
