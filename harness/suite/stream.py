"""Results on disk as they come, a JSON line each, so that an interrupted run can go on."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from harness import __version__
from harness.core.errors import HarnessError
from harness.core.printable import json_printable
from harness.recording.older_runs import in_present_words
from harness.recording.plain import to_plain
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest

if TYPE_CHECKING:
    from pydantic import TypeAdapter

FORMAT = "armharness-stream/2"
KNOWN_FORMATS = ("armharness-stream/1", FORMAT)
FILE = "results.jsonl"
MESHES = (".stl", ".obj", ".dae")
INPUTS = (
    ".yaml",
    ".yml",
    ".sdf",
    ".world",
    ".urdf",
    ".xacro",
    ".srdf",
    ".xml",
    *MESHES,
)
"""Files that count where a scenario, or a file that it names, names them."""

_NAME = re.compile(r"""\"([^\"\n]+)\"|'([^'\n]+)'|([^\s\"',\[\]{}<>=]+)""")


class Stream:
    """Appends results to a file, and gives back those of an earlier run of the same inputs."""

    def __init__(self, folder: Path, *, resume: bool) -> None:
        """Open `folder/results.jsonl`.

        Args:
            folder: Made where it is missing.
            resume: Whether results that are there already are kept; else they are overwritten.

        Raises:
            HarnessError: The file cannot be written.
        """
        self.path = folder / FILE
        self._known: dict[str, CaseResult] = dict(read_results(self.path)) if resume else {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = self.path.open("a" if resume else "w", encoding="utf-8")
        except OSError as error:
            raise HarnessError(f"'{self.path}' cannot be written: {error.strerror}") from error

    def known(self, job: RunRequest) -> CaseResult | None:
        """The result of an earlier run of the same file, values and version; None if there is none.

        An error is no result: it is tried again.
        """
        result = self._known.get(fingerprint(job)) if self._known else None
        return None if result is None or result.outcome == "error" else result

    def write(
        self,
        job: RunRequest,
        result: CaseResult,
        values: Mapping[str, Any] | None = None,
        tags: Sequence[str] = (),
    ) -> None:
        """Keep a result.

        Args:
            job: The case that was run.
            result: The result of the case.
            values: What varies in the case, path -> value.
            tags: The tags of its file.

        Raises:
            HarnessError: The disk is full.
        """
        entry = StreamEntry(fingerprint(job), result, values or {}, tuple(tags))
        try:
            self._file.write(entry.line)
            self._file.flush()
        except OSError as error:
            raise HarnessError(f"'{self.path}' cannot be written: {error.strerror}") from error

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


@dataclass(frozen=True)
class StreamEntry:
    """A line of a stream.

    Attributes:
        key: Fingerprint of what the result follows from.
        result: The result of the case.
        values: What varies in the case, path -> value.
        tags: The tags of its file.
    """

    key: str
    result: CaseResult
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    tags: tuple[str, ...] = ()

    @property
    def line(self) -> str:
        """The entry as a line of the file."""
        entry = {
            "format": FORMAT,
            "key": self.key,
            "values": to_plain(dict(self.values)),
            "tags": list(self.tags),
            "result": to_plain(self.result),
        }
        return f"{json_printable(json.dumps(entry, ensure_ascii=False, allow_nan=False))}\n"


def read_results(path: Path) -> Iterator[tuple[str, CaseResult]]:
    """Keys and results of a stream; a line that was cut off or has another format is left out."""
    return ((entry.key, entry.result) for entry in read_entries(path))


def read_entries(path: Path) -> Iterator[StreamEntry]:
    """The entries of a stream; a line that was cut off or has another format is left out."""
    try:
        with path.open("rb") as file:
            for line in file:
                entry = entry_of(line)
                if entry is not None:
                    yield entry
    except OSError:
        return


def entry_of(line: bytes) -> StreamEntry | None:
    """A line of a stream; None where it was cut off or has another format."""
    try:
        entry = cast("dict[str, Any]", json.loads(line))
        if entry["format"] not in KNOWN_FORMATS:
            return None
        result = result_of(in_present_words(entry["result"]))
        tags = tuple(map(str, entry.get("tags", ())))
        return StreamEntry(str(entry["key"]), result, dict(entry.get("values", {})), tags)
    except (ValueError, KeyError, TypeError, RecursionError):
        return None


def result_of(plain: Mapping[str, Any]) -> CaseResult:
    """A result from its plain data.

    Raises:
        ValueError: It has another shape.
    """
    return _validator().validate_python(plain)


@cache
def _validator() -> TypeAdapter[CaseResult]:
    from pydantic import TypeAdapter

    return TypeAdapter(CaseResult)


def fingerprint(job: RunRequest) -> str:
    """What a case's result follows from: file, files it names, values, seed, version.

    Reporters count as well, as a report that another reporter has not written yet is not complete.
    """
    said = [__version__, file_hash(job.file), job.case, str(job.seed), *_sorted(job.overrides)]
    said += ["strict"] if job.strict else []
    said += [f"reporter {name}" for name in sorted(job.reporters)]
    said += [f"node {name}={command}" for name, command in sorted(job.nodes.items())]
    return hashlib.sha256("\0".join(said).encode()).hexdigest()


def _sorted(overrides: Mapping[str, str]) -> list[str]:
    return [f"{path}={value}" for path, value in sorted(overrides.items())]


@cache
def file_hash(file: Path) -> str:
    """Hash of a scenario file and of the files that it names, and those that they name."""
    hasher = hashlib.sha256()
    for _, content in input_files(file):
        hasher.update(content)
    return hasher.hexdigest()


def input_files(file: Path) -> Iterator[tuple[Path, bytes]]:
    """A scenario file and the files that it names, and those that they name, with their contents.

    A name is any word or quoted text with the ending of an input, from the folder of the file that
    says it: to read one too many does no harm. What packages hold is not followed.
    """
    waiting, seen = [file], set[Path]()
    while waiting:
        path = waiting.pop()
        if path in seen or not path.is_file():
            continue
        seen.add(path)
        try:
            data = path.read_bytes()
        except OSError:
            continue
        yield path, data
        if path.suffix.lower() not in MESHES:
            text = data.decode("utf-8", "replace")
            names = sorted({"".join(groups) for groups in _NAME.findall(text)})
            waiting += [path.parent / name for name in names if name.lower().endswith(INPUTS)]
