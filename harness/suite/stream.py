"""Results on disk as they come, a JSON line each, so that an interrupted run can go on."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from harness import __version__
from harness.core.errors import HarnessError
from harness.core.printable import json_printable
from harness.recording.plain import to_plain
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest

if TYPE_CHECKING:
    from pydantic import TypeAdapter

FORMAT = "armharness-stream/1"
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

    def write(self, job: RunRequest, result: CaseResult) -> None:
        """Keep a result.

        Raises:
            HarnessError: The disk is full.
        """
        line = {"format": FORMAT, "key": fingerprint(job), "result": to_plain(result)}
        try:
            text = json.dumps(line, ensure_ascii=False, allow_nan=False)
            self._file.write(f"{json_printable(text)}\n")
            self._file.flush()
        except OSError as error:
            raise HarnessError(f"'{self.path}' cannot be written: {error.strerror}") from error

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


def read_results(path: Path) -> Iterator[tuple[str, CaseResult]]:
    """Keys and results of a stream; a line that was cut off or has another format is left out."""
    validator = _validator()
    try:
        with path.open(encoding="utf-8") as file:
            for line in file:
                try:
                    entry = cast("dict[str, Any]", json.loads(line))
                    if entry["format"] == FORMAT:
                        yield str(entry["key"]), validator.validate_python(entry["result"])
                except (ValueError, KeyError, TypeError):
                    continue
    except (OSError, UnicodeDecodeError):
        return


@cache
def _validator() -> TypeAdapter[CaseResult]:
    from pydantic import TypeAdapter

    return TypeAdapter(CaseResult)


def fingerprint(job: RunRequest) -> str:
    """What a case's result follows from: file, files it names, values, seed, version."""
    said = [__version__, file_hash(job.file), job.case, str(job.seed), *_sorted(job.overrides)]
    said += ["strict"] if job.strict else []
    return hashlib.sha256("\0".join(said).encode()).hexdigest()


def _sorted(overrides: Mapping[str, str]) -> list[str]:
    return [f"{path}={value}" for path, value in sorted(overrides.items())]


@cache
def file_hash(file: Path) -> str:
    """Hash of a scenario file and of the files that it names, and those that they name.

    A name is any word or quoted text with the ending of an input, from the folder of the file that
    says it: to read one too many does no harm. What packages hold is not followed.
    """
    hasher = hashlib.sha256()
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
        hasher.update(data)
        if path.suffix.lower() not in MESHES:
            text = data.decode("utf-8", "replace")
            names = sorted({"".join(groups) for groups in _NAME.findall(text)})
            waiting += [path.parent / name for name in names if name.lower().endswith(INPUTS)]
    return hasher.hexdigest()
