"""A picture file with a line of text below."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from harness.core.printable import printable

MOST_CHARACTERS = 130
INK = (50, 40, 200)  # BGR


def write_captioned(file: Path, pixels: np.ndarray, caption: str) -> None:
    """Write RGB pixels as a JPEG, a caption over its lowest rows."""
    picture = np.ascontiguousarray(pixels[:, :, ::-1])
    picture[-26:] = (0.25 * picture[-26:] + 0.75 * 255).astype(np.uint8)
    font, line = cv2.FONT_HERSHEY_SIMPLEX, cv2.LINE_AA
    text = printable(caption)[:MOST_CHARACTERS]
    (wide, _), _ = cv2.getTextSize(text, font, 0.45, 1)
    scale = 0.45 * min(1.0, (picture.shape[1] - 20) / max(wide, 1))
    cv2.putText(picture, text, (10, picture.shape[0] - 9), font, scale, INK, 1, line)
    _, content = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 92])
    file.write_bytes(content.tobytes())  # OpenCV crashes on names of files that are no UTF-8
