"""The size of a picture from its header, before anything of it is unpacked."""

from __future__ import annotations

import struct

PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8"
NO_SIZE = {0xC4, 0xC8, 0xCC}  # markers of JPEG between those that begin with the picture's size


def pixels_of(content: bytes) -> int:
    """Pixels of a PNG or JPEG file.

    Raises:
        ValueError: It is neither, or its header is damaged.
    """
    try:
        if content.startswith(PNG):
            width, height = struct.unpack_from(">II", content, 16)
            return width * height
        if content.startswith(JPEG):
            return _pixels_of_jpeg(content)
    except struct.error:
        raise ValueError("the header of the picture is cut off") from None
    raise ValueError("it is neither a PNG nor a JPEG picture")


def _pixels_of_jpeg(content: bytes) -> int:
    place = 2
    while True:
        mark, kind, length = struct.unpack_from(">BBH", content, place)
        if mark != 0xFF or length < 2:
            raise ValueError("the header of the picture is damaged")
        if 0xC0 <= kind <= 0xCF and kind not in NO_SIZE:
            height, width = struct.unpack_from(">HH", content, place + 5)
            return width * height
        place += 2 + length
