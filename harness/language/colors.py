"""Colours by name, as in CSS, and as `#rrggbb`."""

from __future__ import annotations

import re
from typing import Any

from harness.core.suggestion import nearest
from harness.language.files.mistakes import MistakeError, value_text

HEXADECIMAL = re.compile(r"#([0-9a-fA-F]{6})([0-9a-fA-F]{2})?")


def color_of_name(value: Any) -> Any:
    """Red, green, blue, opacity of a colour's name or of `#rrggbb`; lists of numbers pass.

    Raises:
        MistakeError: No colour has this name.
    """
    if not isinstance(value, str):
        return value
    if HEXADECIMAL.fullmatch(value):
        digits = value
    else:
        from PIL.ImageColor import colormap  # CSS Color Module Level 4; takes time

        digits = str(colormap.get(value.lower().replace(" ", ""), ""))
        if not digits:
            hint = (
                "write a CSS name (red, steelblue, ...), '#rrggbb', or [red, green, blue, opacity]"
            )
            near = nearest(value, colormap.keys())
            start = f"did you mean `{near}`? " if near else ""
            raise MistakeError(f"no colour is called {value_text(value)}", start + hint)
    parts = [int(digits[place : place + 2], 16) / 255 for place in range(1, len(digits), 2)]
    return (*parts, 1.0)[:4]


color_of_name.schema = {"type": "string"}  # type: ignore[attr-defined]  # read by the schema
color_of_name.words = "a colour"  # type: ignore[attr-defined]  # read by the reference
