"""JSON documents with a format that says what they are."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, cast

from harness.core.files import read_at_most
from harness.core.limits import RESULTS_DOCUMENT
from harness.core.untrusted_json import parse_json
from harness.suite.discovery import UsageError


def read_document(file: Path, format_name: str, advice: str) -> dict[str, Any]:
    """A JSON document of a format.

    Args:
        advice: What to do where the file cannot be read.

    Raises:
        UsageError: The file cannot be read, or has another format.
    """
    try:
        content = read_at_most(file, RESULTS_DOCUMENT)
        document = parse_json(content)
        if b"\\ud" in content.lower():
            json.dumps(document, ensure_ascii=False).encode()  # half a character is no text
    except OSError as error:
        raise UsageError(f"'{file}' cannot be read: {error.strerror}; {advice}") from error
    except ValueError as error:
        raise UsageError(f"'{file}' is no JSON: {error}") from error
    stated = cast("dict[str, Any]", document).get("format") if isinstance(document, dict) else None
    if stated != format_name:
        raise UsageError(f"'{file}' has the format {stated!r} instead of '{format_name}'")
    return cast("dict[str, Any]", document)
