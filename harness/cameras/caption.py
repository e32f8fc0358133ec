"""Picture files with a line of text below the picture."""

from __future__ import annotations

import cv2
import numpy as np

from harness.core.printable import printable

MOST_CHARACTERS = 130  # of a caption, which is one line
RED, DARK = (50, 40, 200), (50, 45, 40)  # BGR
FONT, SIZE, MARGIN = cv2.FONT_HERSHEY_SIMPLEX, 0.45, 10


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
    """A picture with a caption over its lowest rows, BGR.

    Args:
        pixels: The picture, RGB, shape (height, width, 3), uint8.
        caption: Text at the left, scaled down to fit.
        ink: Colour of the caption, BGR.
        status: Text at the right.
        status_ink: Colour of the status, BGR.
    """
    picture = np.ascontiguousarray(pixels[:, :, ::-1])
    picture[-26:] = (0.25 * picture[-26:] + 0.75 * 255).astype(np.uint8)
    height, right = picture.shape[0] - 9, picture.shape[1] - MARGIN
    if status:
        right -= cv2.getTextSize(status, FONT, SIZE, 1)[0][0]
        cv2.putText(picture, status, (right, height), FONT, SIZE, status_ink, 1, cv2.LINE_AA)
        right -= MARGIN
    text = printable(caption)[:MOST_CHARACTERS]
    wide = cv2.getTextSize(text, FONT, SIZE, 1)[0][0]
    scale = SIZE * min(1.0, (right - MARGIN) / max(wide, 1))
    cv2.putText(picture, text, (MARGIN, height), FONT, scale, ink, 1, cv2.LINE_AA)
    return picture


def jpeg(picture: np.ndarray) -> bytes:
    """A BGR picture as a JPEG file."""
    _, content = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 92])
    return content.tobytes()
