"""Small pictures for pages, from the stills of a run."""

from __future__ import annotations

from pathlib import Path

from harness.core.picture_files import colours, resized, webp
from harness.recording.files import FolderFiles

CAPTION_SHARE = 26 / 480  # of a still's height: the strip below with words too small for a page
QUALITY = 70  # [%] of WebP


def small_still(folder: Path, name: str, width: int) -> bytes | None:
    """A still without its caption, as WebP of a width [pixels]; None where there is no picture."""
    if not (folder / name).is_file():
        return None
    picture = colours(FolderFiles(folder, [name])[name])
    if picture is None:
        return None
    picture = picture[: round(picture.shape[0] * (1 - CAPTION_SHARE))]
    height = round(picture.shape[0] * width / picture.shape[1])
    return webp(resized(picture, width, height), QUALITY)
