"""Messages of a ROS 1 bag (format 2.0), read from its first record to its last."""

from __future__ import annotations

import bz2
import io
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from lz4.frame import LZ4FrameDecompressor

from harness.core.errors import HarnessError
from harness.core.limits import BAG_HEADER, BAG_RECORD, BAG_TOPICS
from harness.plugins.grading.bag.message_files import (
    RawMessage,
    bag_error,
)

MAGIC = b"#ROSBAG V2.0\n"
MESSAGE, CHUNK, CONNECTION = 2, 5, 7
"""Operation codes of the records that count; the others are the index."""

RENAMED = {"tf/msg/tfMessage": "tf2_msgs/msg/TFMessage"}  # types that had another name

Fields = Mapping[str, bytes]


class _CutOffError(Exception):
    """A record ends after the file."""


def ros1_messages(file: Path, named: Path) -> Iterator[RawMessage]:
    """Every message of a ROS 1 bag, whether or not its recorder closed it.

    Args:
        file: The file to read.
        named: The file in messages; it differs from `file` when that is an unpacked copy.

    Raises:
        SpecError: The file is damaged, or no ROS 1 bag of format 2.0.

    References:
        http://wiki.ros.org/Bags/Format/2.0
    """
    with file.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise bag_error(named, "is no ROS 1 bag of format 2.0")
        topics: dict[bytes, tuple[str, str]] = {}
        try:
            for fields, data in _all_records(stream, named):
                operation, number = fields["op"][0], fields.get("conn", b"")
                if operation == CONNECTION and len(topics) < BAG_TOPICS:
                    kind = _fields(data)["type"].decode().replace("/", "/msg/")
                    topics[number] = (fields["topic"].decode(), RENAMED.get(kind, kind))
                elif operation == MESSAGE:
                    seconds, nanoseconds = struct.unpack("<II", fields["time"])
                    time = seconds * 10**9 + nanoseconds
                    yield RawMessage(*topics[number], time, data, is_ros1=True)
        except HarnessError:
            raise
        except _CutOffError as error:
            hint = "`rosbag reindex FILE` saves what is whole"
            raise bag_error(named, f"is cut off after {file.stat().st_size} bytes", hint) from error
        except (KeyError, IndexError, ValueError, OSError, RuntimeError, struct.error) as error:
            place = f"near byte {stream.tell()}"
            raise bag_error(named, f"is damaged {place}: {error}") from error


def _all_records(stream: BinaryIO, named: Path) -> Iterator[tuple[Fields, bytes]]:
    """All records; those of chunks in place of the chunks, which are unpacked within bounds."""
    for fields, data in _records(stream, named):
        if fields["op"][0] == CHUNK:
            yield from _records(io.BytesIO(_unpacked(fields, data, named)), named)
        else:
            yield fields, data


def _records(stream: BinaryIO, named: Path) -> Iterator[tuple[Fields, bytes]]:
    while size := stream.read(4):
        header = _read(stream, size, named, BAG_HEADER)
        yield _fields(header), _read(stream, stream.read(4), named)


def _read(stream: BinaryIO, size: bytes, named: Path, largest: int = BAG_RECORD) -> bytes:
    """As many bytes as the four before them say."""
    if len(size) < 4:
        raise _CutOffError
    (count,) = struct.unpack("<I", size)
    if count > largest:
        raise bag_error(named, f"has a record of {count} bytes; at most {largest} bytes are read")
    data = stream.read(count)
    if len(data) < count:
        raise _CutOffError
    return data


def _fields(header: bytes) -> Fields:
    """The values of a header by their names."""
    found: dict[str, bytes] = {}
    place = 0
    while place < len(header):
        (count,) = struct.unpack_from("<I", header, place)
        name, _, value = header[place + 4 : place + 4 + count].partition(b"=")
        found[name.decode()] = value
        place += 4 + count
    return found


def _unpacked(fields: Fields, data: bytes, named: Path) -> bytes:
    (size,) = struct.unpack("<I", fields["size"])
    if size > BAG_RECORD:
        raise bag_error(named, f"has a chunk of {size} bytes; at most {BAG_RECORD} bytes are read")
    match fields["compression"]:
        case b"none":
            return data
        case b"bz2":
            return bz2.BZ2Decompressor().decompress(data, max_length=size)
        case b"lz4":
            return LZ4FrameDecompressor().decompress(data, max_length=size)
        case other:
            raise bag_error(named, f"has chunks compressed by {other!r}; known: bz2, lz4")
