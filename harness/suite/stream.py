"""Results on disk as they come, a JSON line each, so that an interrupted run can go on."""

from __future__ import annotations

import hashlib
import os
import weakref
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any, BinaryIO, Literal, NamedTuple, TypeVar

from harness.core.errors import HarnessError
from harness.core.inputs import content_hash
from harness.core.limits import RESULTS_LINE
from harness.reporting.json_text import compact_json
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.folders import place_of
from harness.suite.installation import installation, search_environment

if TYPE_CHECKING:
    from pydantic import TypeAdapter

FORMAT: Literal["armharness-stream/3"] = "armharness-stream/3"
LEFT_OUT = "armharness-left-out/1"
INPUTS = "armharness-inputs/1"
CHECK = ',"check":"'  # how the end of a line begins that has the checksum of the text before it

CHECK_DIGITS = 16  # hexadecimal, of a SHA-256: 64 bits show damage
FILE = "results.jsonl"

L = TypeVar("L")  # a kind of line


class Place(NamedTuple):
    """Where a line stands in a file.

    Attributes:
        offset: The number of bytes before the line.
        length: The number of its bytes, the line end included.
    """

    offset: int
    length: int


@dataclass(frozen=True)
class StreamEntry:
    """A line of a stream.

    Attributes:
        key: Fingerprint of what the result follows from.
        values: What varies in the case, path -> value.
        inputs: The digest of the files that the result follows from; an earlier line lists them.
    """

    key: str
    result: CaseResult
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    tags: tuple[str, ...] = ()
    inputs: str = ""
    format: Literal["armharness-stream/3"] = FORMAT

    @property
    def line(self) -> bytes:
        content = {
            "format": self.format,
            "key": self.key,
            "inputs": self.inputs,
            "values": self.values,
            "tags": self.tags,
            "result": self.result,
        }
        return checked_line(compact_json(content, not_finite="strings"))


@dataclass(frozen=True)
class Inputs:
    """A line of a stream that lists files which results follow from.

    Attributes:
        digest: A hash of the list, which the lines of results name.
        files: The path of each file, as the command's working directory shows it -> its hash, which
            is empty where there was no file.
    """

    format: Literal["armharness-inputs/1"]
    digest: str
    files: Mapping[str, str]

    @classmethod
    def of(cls, read: Mapping[str, str]) -> Inputs:
        """The line of the files that a case has read, by their absolute paths."""
        here = Path.cwd()
        files = {
            str(path.relative_to(here) if path.is_relative_to(here) else path): digest
            for path, digest in sorted((Path(each), digest) for each, digest in read.items())
        }
        text = compact_json(files).encode("utf-8", "surrogateescape")
        return cls(INPUTS, hashlib.sha256(text).hexdigest()[:CHECK_DIGITS], files)


@dataclass(frozen=True)
class LeftOut:
    """A line of a stream that names the results which the suite does not count.

    They are samples that the sequential test did not need, and results of earlier runs whose case
    is not in the suite. The last such line holds.

    Attributes:
        keys: The fingerprints of the results that do not count.
    """

    format: Literal["armharness-left-out/1"]
    keys: Sequence[str]


class Stream:
    """Appends results to a file, and reads them again, also those of an earlier run."""

    def __init__(self, folder: Path | None, *, resume: bool = False, name: str = FILE) -> None:
        """Open `folder/results.jsonl`.

        Args:
            folder: Made where it is missing; None: the file has no name, and ends with the process.
            name: The name of the file, until it is renamed.
            resume: Whether results that are there already are kept; else they are overwritten.

        Raises:
            HarnessError: The file cannot be written.
        """
        self.path = Path(name) if folder is None else folder / name
        self._known: dict[str, Place] = {}
        self._unused = set[str]()
        self._inputs: dict[str, Inputs] = {}
        self._changed: dict[str, bool] = {}
        self._leaves_out = False  # whether an earlier run did
        try:
            if folder is None:
                file = TemporaryFile(buffering=0)  # noqa: SIM115 - closed with this object
            else:
                folder.mkdir(parents=True, exist_ok=True)
                file = self.path.open("a+b" if resume else "w+b", buffering=0)
            self.close = weakref.finalize(self, file.close)
            self._file = file
            self._end = file.seek(0, os.SEEK_END)
            if resume and self._end:
                self._read_known()
        except OSError as error:
            raise self._error(error) from error

    def _read_known(self) -> None:
        """Read which results there are; lines that were cut off, damaged or edited are blanked.

        The other lines stay where they are: those who follow a stream know them by their places.
        """
        damaged: list[Place] = []
        whole = 0
        with self.path.open("r+b") as file:
            for place, line in lines_of(file):
                whole = place.offset + place.length
                if not is_intact(line):
                    damaged.append(place)
                elif (entry := read_line(line, StreamEntry)) is not None:
                    self._known[entry.key] = place
                elif (inputs := read_line(line, Inputs)) is not None:
                    self._inputs[inputs.digest] = inputs
                elif (left_out := read_line(line, LeftOut)) is not None:
                    self._leaves_out = bool(left_out.keys)
            for place in damaged:
                entry = read_line(os.pread(file.fileno(), place.length, place.offset), StreamEntry)
                self._unused.update([] if entry is None else [entry.key])
                os.pwrite(file.fileno(), b" " * (place.length - 1), place.offset)
            os.pwrite(file.fileno(), b" " * (self._end - whole), whole)
        self._unused.update(self._known)
        if whole != self._end:
            self.append(b"\n")

    def known(self, job: RunRequest) -> tuple[Place, CaseResult] | None:
        """An earlier run's result from the same inputs; None if there is none.

        An error is no result: it is tried again. So is an invalid file, as what it lacks may be
        there now.
        """
        if not self._known:
            return None
        key = fingerprint(job)
        self._unused.discard(key)
        if key not in self._known:
            return None
        entry = self.entry(place := self._known[key])
        is_result = entry.result.outcome in ("passed", "failed")
        return (place, entry.result) if is_result and self._has_same_inputs(entry.inputs) else None

    def _has_same_inputs(self, digest: str) -> bool:
        """Whether all files that results follow from are as they were."""
        inputs = self._inputs.get(digest)
        if inputs is None:
            return False
        if digest not in self._changed:
            self._changed[digest] = any(
                content_hash(Path(path)) != before for path, before in inputs.files.items()
            )
        return not self._changed[digest]

    def write(
        self,
        job: RunRequest,
        result: CaseResult,
        values: Mapping[str, Any] | None = None,
        tags: Sequence[str] = (),
    ) -> Place:
        """Keep a result.

        Args:
            values: What varies in the case, path -> value.

        Raises:
            HarnessError: The disk is full.
        """
        inputs = Inputs.of(result.inputs)
        if self._inputs.get(inputs.digest) != inputs:
            self._inputs[inputs.digest] = inputs
            self.append(checked_line(compact_json(inputs)))
        result = replace(result, inputs={})
        entry = StreamEntry(fingerprint(job), result, values or {}, tuple(tags), inputs.digest)
        return self.append(entry.line)

    def leave_out(self, places: Iterable[Place]) -> None:
        """Note the results that do not count: those at some places, and unknown ones.

        Raises:
            HarnessError: The disk is full.
        """
        keys = [*(self.entry(each).key for each in places), *sorted(self._unused)]
        if keys or self._leaves_out:
            self.append(checked_line(compact_json(LeftOut(LEFT_OUT, keys))))

    def append(self, line: bytes) -> Place:
        """Add a line, and return its place.

        Raises:
            HarnessError: The disk is full.
        """
        rest = line
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            raise self._error(error) from error
        place = Place(self._end, len(line))
        self._end += len(line)
        return place

    def rename(self) -> None:
        """Give a file that was written under another name its own.

        Raises:
            HarnessError: It cannot be renamed.
        """
        try:
            self.path = self.path.replace(self.path.with_name(FILE))
        except OSError as error:
            raise self._error(error) from error

    def _error(self, error: OSError) -> HarnessError:
        return HarnessError(f"'{self.path}' cannot be written: {error.strerror}")

    def entry(self, place: Place) -> StreamEntry:
        """The entry that was written to a place."""
        line = os.pread(self._file.fileno(), place.length, place.offset)
        entry = read_line(line, StreamEntry)
        if entry is None:
            raise HarnessError(f"'{self.path}' was changed while it was in use")
        return entry


def lines_of(file: BinaryIO) -> Iterator[tuple[Place, bytes]]:
    """The lines of a file from where it stands, without one that has no end."""
    offset = file.tell()
    for line in iter(lambda: file.readline(RESULTS_LINE), b""):
        if line.endswith(b"\n"):
            yield Place(offset, len(line)), line
        offset += len(line)


def checked_line(text: str) -> bytes:
    """A JSON object as a line that ends with a checksum of its text.

    The checksum shows that a line was damaged or edited. It does not stop a person who computes it
    anew.
    """
    content = text.removesuffix("}").encode("utf-8", "surrogateescape")
    return content + f'{CHECK}{_checksum(content)}"}}\n'.encode()


def is_intact(line: bytes) -> bool:
    """Whether a line has the checksum of its text; lines of older formats have none."""
    content, mark, end = line.rpartition(CHECK.encode())
    return bool(mark) and end.rstrip() == f'{_checksum(content)}"}}'.encode()


def _checksum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:CHECK_DIGITS]


def read_line(line: bytes, kind: type[L]) -> L | None:
    """A line of a stream; None where it was cut off, or is of another kind."""
    try:
        return validator(kind).validate_json(line)
    except ValueError:
        return None


def result_of(plain: Mapping[str, Any]) -> CaseResult:
    """A result from its plain data.

    Raises:
        ValueError: It has another shape.
    """
    return validator(CaseResult).validate_python(plain)


@cache
def validator(kind: type) -> TypeAdapter[Any]:
    """Reads records of a type from JSON or plain data."""
    from pydantic import TypeAdapter

    return TypeAdapter(kind)


def fingerprint(job: RunRequest) -> str:
    """What a case's result follows from besides files: program, case, values, seed, options.

    Reporters count as well, as a report that another reporter has not written yet is not complete.
    """
    environment = sorted(search_environment().items())
    parts = [installation().digest, repr(environment), place_of(job.file).as_posix()]
    parts += [job.case, str(job.seed), *_sorted(job.overrides)]
    parts += ["strict"] if job.strict else []
    parts += [f"reporter {name}" for name in sorted(job.reporters)]
    parts += [f"node {name}={command}" for name, command in sorted(job.nodes.items())]
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogateescape")).hexdigest()


def _sorted(overrides: Mapping[str, str]) -> list[str]:
    return [f"{path}={value}" for path, value in sorted(overrides.items())]
