"""The files of a recording, and an iterator over their messages with bounded memory."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import Any

import yaml
import zstandard

from harness.core.errors import Problem, SpecError
from harness.core.limits import BAG_FILE, BAG_METADATA, BAG_RECORD
from harness.plugins.grading.bag.message_files import (
    RawMessage,
    bag_error,
    mcap_messages,
    sqlite_messages,
    unzstd,
)
from harness.plugins.grading.bag.ros1_messages import ros1_messages

METADATA = "metadata.yaml"
SUFFIXES = (".mcap", ".db3")
ROS1 = ".bag"


@dataclass(frozen=True)
class BagFiles:
    """The files of a recording, in order.

    Attributes:
        has_packed_messages: Whether each message is compressed (zstd).
        notes: Irregularities of the files.
    """

    paths: tuple[Path, ...]
    has_packed_messages: bool = False
    notes: tuple[str, ...] = ()


def bag_files(path: Path) -> BagFiles:
    """The files of a recording: a rosbag2 folder, or a single file, of ROS 1 too.

    Raises:
        SpecError: There is no recording, or its metadata cannot be read.
    """
    if path.is_file():
        if _suffix(path) not in (*SUFFIXES, ROS1):
            known = f"known: folders, {', '.join(SUFFIXES)} and {ROS1}"
            raise bag_error(path, "is not a recording", known)
        return BagFiles((path,))
    if not path.is_dir():
        raise bag_error(path, "there is no such recording")
    if (path / METADATA).is_file():
        return _of_metadata(path)
    found = tuple(sorted(file for file in path.iterdir() if _suffix(file) in SUFFIXES))
    if not found:
        raise bag_error(
            path, f"is not a recording: it has no {METADATA}, no .mcap and no .db3 file"
        )
    note = f"{METADATA} is missing, as after a recorder was killed; the files are read without it"
    return BagFiles(found, notes=(note,))


def messages(files: BagFiles) -> Iterator[RawMessage]:
    """Every message, in the order of the files.

    Raises:
        SpecError: A file is empty, cut off, damaged, or of another format.
    """
    for path in files.paths:
        with tempfile.TemporaryDirectory() as place:
            file = _unpacked(path, Path(place)) if path.suffix == ".zstd" else path
            if not file.stat().st_size:
                raise bag_error(path, "is empty")
            for message in READERS[_suffix(path)](file, path):
                if files.has_packed_messages:
                    data = unzstd(message.data, BAG_RECORD, path)
                    yield replace(message, data=data)
                else:
                    yield message


READERS = {".mcap": mcap_messages, ".db3": sqlite_messages, ROS1: ros1_messages}


def _of_metadata(folder: Path) -> BagFiles:
    file = folder / METADATA
    if file.stat().st_size > BAG_METADATA:
        raise bag_error(file, f"is larger than {BAG_METADATA // 2**20} MB")
    content = _plain_yaml(file)
    about: Any = content.get("rosbag2_bagfile_information") if isinstance(content, dict) else None
    names: Any = about.get("relative_file_paths") if isinstance(about, dict) else None
    if not isinstance(names, list) or not names:
        raise bag_error(file, "does not list the recording's files")
    paths = tuple(folder / PurePath(str(name)).name for name in names)
    for path in paths:
        if not path.is_file():
            raise bag_error(path, f"is missing, although {METADATA} lists it")
        if _suffix(path) not in SUFFIXES:
            raise bag_error(path, "is neither an .mcap nor a .db3 file")
    is_packed = str(about.get("compression_mode") or "").lower() == "message"
    return BagFiles(paths, is_packed)


def _plain_yaml(file: Path) -> Any:
    try:
        return yaml.load(file.read_bytes(), Loader=yaml.CSafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = (mark.line + 1, mark.column + 1) if mark else (0, 0)
        raise SpecError(
            [Problem(str(file), *place, f"is not valid YAML: {error.problem}")]
        ) from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise bag_error(file, f"is not valid YAML: {error}") from error


def _suffix(path: Path) -> str:
    name = path.with_suffix("") if path.suffix == ".zstd" else path
    return name.suffix.lower()


def _unpacked(path: Path, place: Path) -> Path:
    """The unpacked copy of a file that is compressed as a whole."""
    target, left = place / path.stem, BAG_FILE
    try:
        with path.open("rb") as packed, target.open("wb") as plain:
            stream = zstandard.ZstdDecompressor().stream_reader(packed)
            while block := stream.read(2**20):
                left -= len(block)
                if left < 0:
                    raise bag_error(path, f"unpacks to more than {BAG_FILE} bytes")
                plain.write(block)
    except zstandard.ZstdError as error:
        raise bag_error(path, f"cannot be unpacked: {error}") from error
    return target
