"""Recorded messages, and errors of recordings that cannot be used."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import zstandard

from harness.core.errors import Problem, SpecError

LARGEST_RECORD = 256 * 2**20
"""Largest unpacked message or chunk of messages [bytes]."""


@dataclass(frozen=True)
class RawMessage:
    """A recorded message.

    Attributes:
        log_time: Time of receipt by the recorder's clock [ns].
        data: The message in CDR.
    """

    topic: str
    msgtype: str
    log_time: int
    data: bytes


def bag_error(path: Path, message: str, hint: str = "") -> SpecError:
    """The error of a recording that cannot be used."""
    return SpecError([Problem(str(path), 0, 0, message, hint)])


def unzstd(data: bytes, largest: int, named: Path) -> bytes:
    """Unpack data of at most a given size, whatever size the data declare."""
    with zstandard.ZstdDecompressor().stream_reader(data) as stream:
        content = stream.read(largest + 1)
    if len(content) > largest:
        raise bag_error(named, f"unpacks to more than the maximum of {largest} bytes")
    return content
