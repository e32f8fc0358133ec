"""Pictures as PNG, JPEG and WebP files."""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from PIL import Image
from PIL import WebPImagePlugin as WebPImagePlugin  # otherwise Pillow imports all its formats

Pixels = np.ndarray[Any, Any]
"""RGB, shape (height, width, 3), uint8, or one channel, shape (height, width), uint8 or uint16."""

TOO_LARGE = (Image.DecompressionBombWarning, Image.DecompressionBombError)


def png(pixels: Pixels) -> bytes:
    """A lossless file."""
    return _encoded(pixels, "PNG", {"compress_level": 3})


def jpeg(pixels: Pixels, quality: int = 92) -> bytes:
    """A JPEG file of a quality from 1 to 100."""
    return _encoded(pixels, "JPEG", {"quality": quality})


def webp(pixels: Pixels, quality: int) -> bytes:
    """A lossy WebP file of a quality from 1 to 100."""
    return _encoded(pixels, "WEBP", {"quality": quality})


def decoded(content: bytes) -> Pixels | None:
    """The pixels of a PNG, JPEG or WebP file; None where they cannot be read, or are too many."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            picture = Image.open(io.BytesIO(content), formats=("PNG", "JPEG", "WEBP"))
        is_rgb = len(picture.getbands()) > 1 or picture.mode == "P"
        return np.array(picture.convert("RGB") if is_rgb else picture)
    except (OSError, SyntaxError, ValueError, *TOO_LARGE):
        return None


def pixels_of(content: bytes) -> int:
    """The number of pixels of a PNG or JPEG file by its header; nothing is unpacked.

    Raises:
        ValueError: It is neither, or its header is damaged.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            width, height = Image.open(io.BytesIO(content), formats=("PNG", "JPEG")).size
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise ValueError("it is neither a PNG nor a JPEG picture") from error
    return width * height


def colours(content: bytes) -> Pixels | None:
    """The pixels of a file as RGB; None where they cannot be read."""
    pixels = decoded(content)
    return pixels if pixels is None or pixels.ndim == 3 else np.stack([pixels] * 3, axis=-1)


def grey(pixels: Pixels) -> Pixels:
    """The luma of RGB pixels (ITU-R BT.601, in units of 2^-15 as OpenCV rounds it)."""
    return ((pixels.astype(np.int32) @ (9798, 19235, 3735) + 2**14) >> 15).astype(np.uint8)


def resized(pixels: Pixels, width: int, height: int) -> Pixels:
    """The picture at another size [pixels]."""
    return np.array(Image.fromarray(pixels).resize((width, height), Image.Resampling.LANCZOS))


def _encoded(pixels: Pixels, kind: str, options: Mapping[str, int]) -> bytes:
    content = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(content, kind, **options)
    return content.getvalue()
