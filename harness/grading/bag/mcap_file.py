"""Messages of an MCAP file, record by record, in the order of the file.

QoS metadata is not read: its variants are no reason to refuse a recording.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import zstandard
from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import EndOfFile
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import CRCValidationError, StreamReader, breakup_chunk

from harness.core.errors import HarnessError
from harness.grading.bag.raw import LARGEST_RECORD, RawMessage, bag_error, unzstd

RECOVER = "`mcap recover FILE -o WHOLE.mcap` saves what is whole"
"""Advice for an MCAP file that its recorder did not close."""


def mcap_messages(file: Path, named: Path) -> Iterator[RawMessage]:
    """Every message of an MCAP file.

    Args:
        file: The file to read.
        named: The file in messages; it differs from `file` when that is an unpacked copy.

    Raises:
        SpecError: The file is empty, damaged, or not an MCAP file.
    """
    if not file.stat().st_size:
        raise bag_error(named, "is empty")
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
            place, said = f"near byte {stream.tell()}", str(error) or type(error).__name__
            raise bag_error(named, f"is damaged {place}, or not an MCAP file: {said}") from error


def _mcap_records(stream: Any, named: Path) -> Iterator[Any]:
    """All records; chunks are unpacked within bounds."""
    reader = StreamReader(stream, emit_chunks=True, record_size_limit=LARGEST_RECORD)
    for record in reader.records:
        if isinstance(record, Chunk):
            yield from breakup_chunk(_unpacked_chunk(record, named), validate_crc=True)
        else:
            yield record


def _unpacked_chunk(chunk: Chunk, named: Path) -> Chunk:
    size = chunk.uncompressed_size
    if size > LARGEST_RECORD:
        raise bag_error(
            named, f"has a chunk of {size} bytes; at most {LARGEST_RECORD} bytes are read"
        )
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
