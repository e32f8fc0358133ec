"""Videos as VP8 WebM files, which browsers and players read without another codec."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np

from harness.recording.quiet import quiet_stderr

TRACK_UID = b"\x73\xc5\x88"
"""Matroska's element for it, and that its content has 8 bytes."""


def film_size(width: int, height: int, widest: int | None = None) -> tuple[int, int]:
    """The size of a video [pixels]: the pictures', or narrower, in even numbers as VP8 has them."""
    scale = 1.0 if widest is None else min(1.0, widest / width)
    return max(2, 2 * round(scale * width / 2)), max(2, 2 * round(scale * height / 2))


def encoded_film(frames: Iterable[np.ndarray], rate: float, size: tuple[int, int]) -> bytes:
    """A WebM file of RGB or grey pictures; the same bytes for the same pictures.

    Args:
        frames: The frames, of any size; at least one.
        rate: The number of frames per second.
        size: The size of the video, as `film_size` gives it.
    """
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "film.webm"
        with quiet_stderr():
            writer = cv2.VideoWriter(str(file), cv2.VideoWriter.fourcc(*"VP80"), rate, size)
        for frame in frames:
            colours = frame if frame.ndim == 3 else cv2.cvtColor(frame, cv2.COLOR_GRAY2RGB)
            if colours.shape[1::-1] != size:
                colours = cv2.resize(colours, size, interpolation=cv2.INTER_AREA)
            writer.write(np.ascontiguousarray(colours[:, :, ::-1]))
        with quiet_stderr():
            writer.release()
        return _reproducible(file.read_bytes())


def decoded_film(content: bytes) -> Iterator[np.ndarray]:
    """The RGB pictures of a video file, one after the other; none where it cannot be read."""
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "film.webm"
        file.write_bytes(content)
        with quiet_stderr():
            reader = cv2.VideoCapture(str(file))
        try:
            while True:
                is_there, frame = reader.read()
                if not is_there:
                    return
                yield frame[:, :, ::-1]
        finally:
            reader.release()


def _reproducible(webm: bytes) -> bytes:
    """The same video without the random number that names its track, in two places."""
    place = webm.find(TRACK_UID)
    if place < 0:
        return webm
    begin = place + len(TRACK_UID)
    return webm.replace(webm[begin : begin + 8], (1).to_bytes(8, "big"))
