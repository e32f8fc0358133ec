"""Mistakes found while a file is read, and how a wrong value is quoted."""

from __future__ import annotations

from typing import Any

LONGEST_VALUE = 60  # characters of a value that are quoted


class MistakeError(ValueError):
    """A value that is certainly wrong; validators raise it, the loader adds the place.

    Attributes:
        hint: What to do instead.
        span: Where in a text the mistake is, from 0, and how long; None for all of it.
    """

    def __init__(self, message: str, hint: str = "", span: tuple[int, int] | None = None) -> None:
        self.message = message
        self.hint = hint
        self.span = span
        super().__init__(message)


def value_text(value: Any) -> str:
    """A value as a person would describe it: `` `x` ``, a list, nothing."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if value is None:
        return "nothing"
    text = str(value).lower() if isinstance(value, bool) else str(value)
    if len(text) > LONGEST_VALUE:
        text = text[: LONGEST_VALUE - 3] + "..."
    return f"`{text}`" if text.isprintable() else f"`{text!r}`"
