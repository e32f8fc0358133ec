"""Messages of the files of a recording: MCAP and SQLite in rosbag2's format."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import zstandard
from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import EndOfFile
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import CRCValidationError, StreamReader, breakup_chunk

from harness.core.errors import HarnessError, Problem, SpecError
from harness.core.limits import BAG_RECORD, BAG_TOPICS


@dataclass(frozen=True)
class RawMessage:
    """A recorded message.

    Attributes:
        log_time: Time of receipt by the recorder's clock [ns].
        data: The message in CDR, or as ROS 1 serializes it.
    """

    topic: str
    msgtype: str
    log_time: int
    data: bytes
    is_ros1: bool = False


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


RECOVER = "`mcap recover FILE -o WHOLE.mcap` saves what is whole"
"""Advice for an MCAP file that its recorder did not close."""


def mcap_messages(file: Path, named: Path) -> Iterator[RawMessage]:
    """Every message of an MCAP file.

    Args:
        named: The file in messages; it differs from `file` when that is an unpacked copy.

    Raises:
        SpecError: The file is damaged, or not an MCAP file.
    """
    schemas: dict[int, str] = {}
    channels: dict[int, Channel] = {}
    with file.open("rb") as stream:
        try:
            for record in _mcap_records(stream, named):
                if isinstance(record, Schema):
                    schemas[record.id] = record.name
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message):
                    channel = channels[record.channel_id]
                    msgtype = schemas.get(channel.schema_id, "")
                    if channel.message_encoding == "cdr":
                        yield RawMessage(channel.topic, msgtype, record.log_time, record.data)
        except HarnessError:
            raise
        except EndOfFile as error:
            raise bag_error(
                named, f"is cut off after {file.stat().st_size} bytes", RECOVER
            ) from error
        except CRCValidationError as error:
            place = f"near byte {stream.tell()}"
            raise bag_error(named, f"is damaged {place}: a checksum is wrong", RECOVER) from error
        except (zstandard.ZstdError, RuntimeError, OSError) as error:
            place = f"near byte {stream.tell()}"
            raise bag_error(named, f"cannot be read {place}: {error}") from error
        except Exception as error:
            # whatever the reader raises on damaged bytes: struct.error, MemoryError, KeyError ...
            place, reason = f"near byte {stream.tell()}", str(error) or type(error).__name__
            raise bag_error(named, f"is damaged {place}, or not an MCAP file: {reason}") from error


def _mcap_records(stream: Any, named: Path) -> Iterator[Any]:
    """All records; chunks are unpacked within bounds."""
    reader = StreamReader(stream, emit_chunks=True, record_size_limit=BAG_RECORD)
    for record in reader.records:
        if isinstance(record, Chunk):
            yield from breakup_chunk(_unpacked_chunk(record, named), validate_crc=True)
        else:
            yield record


def _unpacked_chunk(chunk: Chunk, named: Path) -> Chunk:
    size = chunk.uncompressed_size
    if size > BAG_RECORD:
        raise bag_error(named, f"has a chunk of {size} bytes; at most {BAG_RECORD} bytes are read")
    match chunk.compression:
        case "":
            data = chunk.data
        case "zstd":
            data = unzstd(chunk.data, size, named)
        case "lz4":
            data = LZ4FrameDecompressor().decompress(chunk.data, max_length=size)
        case other:
            raise bag_error(named, f"has chunks compressed by '{other}'; known: zstd, lz4")
    return replace(chunk, compression="", data=data)


def sqlite_messages(file: Path, named: Path) -> Iterator[RawMessage]:
    """Every message of a SQLite file.

    Args:
        named: The file in messages; it differs from `file` when that is an unpacked copy.

    Raises:
        SpecError: The file is damaged, or not a SQLite recording.
    """
    try:
        with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as database:
            database.text_factory = _text
            database.execute("PRAGMA trusted_schema = OFF")
            database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, BAG_RECORD)
            kinds = dict(database.execute("SELECT name, type FROM sqlite_master"))
            if any(kinds.get(name) != "table" for name in ("topics", "messages")):
                raise bag_error(
                    named, "is not a recording: it lacks the tables `topics` and `messages`"
                )
            topics = {
                number: (str(name), str(msgtype))
                for number, name, msgtype in database.execute(
                    "SELECT id, name, type FROM topics LIMIT ?", (BAG_TOPICS,)
                )
            }
            rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id")
            for number, time, data in rows:
                if number in topics and isinstance(data, bytes) and isinstance(time, int):
                    yield RawMessage(*topics[number], time, data)
    except (sqlite3.Error, MemoryError, OverflowError, UnicodeDecodeError) as error:
        hint = "`sqlite3 FILE .recover | sqlite3 WHOLE.db3` saves what is whole"
        reason = str(error) or type(error).__name__
        raise bag_error(named, f"cannot be read as a database: {reason}", hint) from error


def _text(data: bytes) -> str:
    """A text of the database, with damaged bytes replaced; names with such bytes match nothing."""
    return data.decode("utf-8", errors="replace")
