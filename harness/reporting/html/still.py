"""Small pictures for pages, from the stills of a run."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

CAPTION_SHARE = 26 / 480  # of a still's height: the strip below with words too small for a page
QUALITY = 70


def small_still(file: Path, width: int) -> bytes | None:
    """A still without its caption, as WebP of a width [pixels]; None where there is no picture."""
    if not file.is_file():
        return None
    picture = cv2.imdecode(np.frombuffer(file.read_bytes(), dtype=np.uint8), cv2.IMREAD_COLOR)
    if picture is None:
        return None
    picture = picture[: round(picture.shape[0] * (1 - CAPTION_SHARE))]
    height = round(picture.shape[0] * width / picture.shape[1])
    picture = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    is_coded, data = cv2.imencode(".webp", picture, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
    return data.tobytes() if is_coded else None
