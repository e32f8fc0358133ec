"""Videos as MP4 files with H.264, which every browser, player and slide program shows."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import Any

import av
import numpy as np
from av.error import FFmpegError
from av.video.reformatter import VideoReformatter

from harness.core.limits import PICTURE_PIXELS

SUFFIX, MEDIA_TYPE = ".mp4", "video/mp4"
OPTIONS = {"preset": "veryfast", "crf": "23", "mbtree": "0"}
"""One thread and no macroblock tree, so that equal pictures give equal bytes: with the tree, films
of 130 x 98 or 150 x 102 pixels differed from one encoding to the next (x264 of av 18)."""

# Pictures are reformatted by an object that ends with its function. The one that `reformat` of
# av 19 keeps for each thread has threads of its own: a fork from another thread waits for them.


def film_size(width: int, height: int, widest: int | None = None) -> tuple[int, int]:
    """The size of a video [pixels]: the pictures', or narrower; H.264 has even numbers."""
    scale = 1.0 if widest is None else min(1.0, widest / width)
    return max(2, 2 * round(scale * width / 2)), max(2, 2 * round(scale * height / 2))


def encoded_film(frames: Iterable[np.ndarray], rate: float, size: tuple[int, int]) -> bytes:
    """A video file of RGB or grey pictures; the same bytes for the same pictures.

    Args:
        frames: The frames, of any size; at least one.
        rate: The number of frames per second.
        size: The size of the video, as `film_size` gives it.
    """
    content = io.BytesIO()
    film: Any = av.open(content, "w", format="mp4")
    with film:
        stream = film.add_stream("libx264", rate=Fraction(rate).limit_denominator(1000))
        stream.options = OPTIONS
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.thread_count = 1
        reformatter = VideoReformatter()
        for frame in frames:
            colours = np.ascontiguousarray(frame)
            kind = "rgb24" if colours.ndim == 3 else "gray"
            picture = av.VideoFrame.from_ndarray(colours, format=kind)
            film.mux(stream.encode(reformatter.reformat(picture, *size, "yuv420p")))
        film.mux(stream.encode())
    return content.getvalue()


def decoded_film(content: bytes) -> Iterator[np.ndarray]:
    """The RGB pictures of a video file, one after the other; none where it cannot be read."""
    try:
        film: Any = av.open(io.BytesIO(content))
        with film:
            codec = film.streams.video[0].codec_context
            if codec.width * codec.height > PICTURE_PIXELS:
                return
            reformatter = VideoReformatter()
            for frame in film.decode(video=0):
                yield reformatter.reformat(frame, format="rgb24").to_ndarray()
    except (FFmpegError, IndexError):
        return
