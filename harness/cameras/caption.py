"""Picture files with a line of text below the picture."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from harness.core.picture_files import jpeg
from harness.core.printable import printable

MOST_CHARACTERS = 130  # of a caption, which is one line
RED, DARK = (200, 40, 50), (40, 45, 50)  # RGB
SIZE, MARGIN, STRIP = 13, 10, 26  # of letters, left and right of them, and of their strip [pixels]


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
) -> np.ndarray:
    """A picture with a caption over its lowest rows, RGB.

    Args:
        pixels: The picture, RGB, shape (height, width, 3), uint8.
        caption: Text at the left, scaled down to fit.
        ink: Colour of the caption, RGB.
        status: Text at the right.
        status_ink: Colour of the status, RGB.
    """
    picture = pixels.copy()
    picture[-STRIP:] = (0.25 * picture[-STRIP:] + 0.75 * 255).astype(np.uint8)
    image = Image.fromarray(picture)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(SIZE)
    right, middle = image.width - MARGIN, image.height - STRIP / 2
    if status:
        draw.text((right, middle), status, status_ink, font, anchor="rm")
        right -= draw.textlength(status, font) + MARGIN
    text = printable(caption)[:MOST_CHARACTERS]
    scale = min(1.0, (right - MARGIN) / max(draw.textlength(text, font), 1))
    draw.text((MARGIN, middle), text, ink, ImageFont.load_default(scale * SIZE), anchor="lm")
    return np.array(image)
