"""Picture files with a line of text below the picture."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from harness.core.picture_files import jpeg
from harness.core.printable import printable

RED, DARK = (200, 40, 50), (40, 45, 50)  # RGB
SIZE = 13  # of letters [pixels]
LINE = 1.25  # from one line to the next, in sizes
ELLIPSIS = "…"
Font = ImageFont.FreeTypeFont | ImageFont.ImageFont
PAPER = 246  # the strip's grey, from 0 to 255


def strip_height(size: int = SIZE, lines: int = 1) -> int:
    """The height of the strip for some lines of letters of a size [pixels]."""
    return size + round((lines - 1) * LINE * size) + size


def captioned_jpeg(
    pixels: np.ndarray,
    caption: str,
    *,
    ink: tuple[int, int, int] = RED,
    status: str = "",
    status_ink: tuple[int, int, int] = DARK,
) -> bytes:
    """RGB pixels as a JPEG file with a caption; arguments as of `captioned`."""
    return jpeg(captioned(pixels, caption, ink=ink, status=status, status_ink=status_ink))


def captioned(
    pixels: np.ndarray,
    caption: str,
    *,
    ink: tuple[int, int, int] = RED,
    status: str = "",
    status_ink: tuple[int, int, int] = DARK,
    size: int = SIZE,
    lines: int = 1,
) -> np.ndarray:
    """A picture above a strip with its caption, RGB, `strip_height(size, lines)` higher.

    Args:
        pixels: The picture, RGB, shape (height, width, 3), uint8.
        caption: Text at the left; what has no room is replaced by an ellipsis.
        ink: Colour of the caption, RGB.
        status: Text at the right of the first line.
        status_ink: Colour of the status, RGB.
        size: Size of the letters [pixels].
        lines: The number of lines that the strip has room for.
    """
    height, width = pixels.shape[:2]
    strip = np.full((strip_height(size, lines), width, 3), PAPER, np.uint8)
    image = Image.fromarray(np.concatenate([pixels, strip]))
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size)
    right, middle = width - size, height + size
    if status:
        draw.text((right, middle), status, status_ink, font, anchor="rm")
        right -= int(draw.textlength(status, font)) + size
    rooms = [right - size, *[width - 2 * size] * (lines - 1)]
    for number, text in enumerate(_wrapped(printable(caption), rooms, font)):
        draw.text((size, middle + number * LINE * size), text, ink, font, anchor="lm")
    return np.array(image)


def _wrapped(text: str, rooms: Sequence[float], font: Font) -> list[str]:
    """The lines of a text, each no longer than its room [pixels]; the last one may be cut."""
    *rooms, last = rooms
    lines: list[str] = []
    for room in rooms:
        end = _fitting(text, room, font)
        if end < len(text):
            end = text.rfind(" ", 0, end + 1) + 1 or end
        lines.append(text[:end].rstrip())
        text = text[end:]
    end = _fitting(text, last, font)
    if end < len(text):
        text = f"{text[: _fitting(text, last - font.getlength(ELLIPSIS), font)].rstrip()}{ELLIPSIS}"
    return [*lines, text]


def _fitting(text: str, room: float, font: Font) -> int:
    """How many characters of a text fit into a room [pixels]."""
    return bisect_right(range(1, len(text) + 1), room, key=lambda end: font.getlength(text[:end]))
