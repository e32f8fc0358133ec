"""Messages as they were recorded, and what to say of a recording that cannot be used."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import zstandard

from harness.core.errors import Problem, SpecError

LARGEST_RECORD = 256 * 2**20
"""Of a message or a chunk of messages, unpacked [bytes]."""


@dataclass(frozen=True)
class RawMessage:
    """A message as it was recorded.

    Attributes:
        log_time: When the recorder got it, by its clock [ns].
        data: In CDR.
    """

    topic: str
    msgtype: str
    log_time: int
    data: bytes


def bag_error(path: Path, message: str, hint: str = "") -> SpecError:
    """A recording that cannot be used."""
    return SpecError([Problem(str(path), 0, 0, message, hint)])


def unzstd(data: bytes, largest: int, named: Path) -> bytes:
    """Unpack at most so many bytes, whatever the data say of themselves."""
    with zstandard.ZstdDecompressor().stream_reader(data) as stream:
        content = stream.read(largest + 1)
    if len(content) > largest:
        raise bag_error(named, f"unpacks to more than the {largest} bytes that it may have")
    return content
