"""A batch of cases on a node of a cluster: unpack the files, run each case isolated, pack reports.

This module runs in the processes that a cluster starts on its nodes.
"""

from __future__ import annotations

import atexit
import hashlib
import io
import json
import os
import platform
import shutil
import tarfile
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from harness.recording.plain import to_plain
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.cases import run_isolated
from harness.suite.installation import Installation, installation
from harness.suite.leftovers import remove_abandoned
from harness.suite.stream import result_of
from harness.suite.warm import WarmServer

PREFIX = "harness-batch-"  # how the names of folders begin; the number of the process follows


@dataclass(frozen=True)
class Files:
    """Files that scenarios name, for a node that does not have them.

    Attributes:
        contents: Absolute path -> content.
        folder: The working directory of the command.
        environment: Environment variables that runs depend on.
    """

    contents: Mapping[str, bytes]
    folder: str
    environment: Mapping[str, str]

    @property
    def key(self) -> str:
        """The same for the same files."""
        hasher = hashlib.sha256(f"{self.folder}\0{sorted(self.environment.items())}".encode())
        for path, content in sorted(self.contents.items()):
            hasher.update(f"\0{path}\0{len(content)}\0".encode() + content)
        return hasher.hexdigest()


@dataclass(frozen=True)
class Batch:
    """Cases that one process of a node runs one after the other.

    Attributes:
        hard_cap: Wall seconds a case may take; None: the program's own.
    """

    cases: tuple[tuple[int, RunRequest], ...]
    installation: Installation
    hard_cap: float | None


@dataclass(frozen=True)
class BatchResult:
    """The results of a batch.

    Attributes:
        results: Index, result and packed report of each case; no bytes without a report.
        refusal: Why nothing was run: the node has another installation.
        processor: The processor family of the node.
        seconds: Wall time of the batch.
    """

    results: tuple[tuple[int, CaseResult, bytes], ...] = ()
    refusal: str = ""
    processor: str = ""
    seconds: float = 0.0


@cache
def processor_family() -> str:
    """The processor family, on which the last digit of a result may depend."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.machine()
    pairs = (line.partition(":") for line in text.splitlines())
    fields = {key.strip(): value.strip() for key, _, value in pairs}
    names = (fields.get(name, "") for name in ("vendor_id", "cpu family", "model"))
    return " ".join(filter(None, (platform.machine(), *names)))


def run_batch(batch: Batch, files: Files) -> BatchResult:
    """Run the cases of a batch, each in a process of its own."""
    begin = time.monotonic()
    difference = batch.installation.difference(installation())
    if difference:
        return BatchResult(refusal=f"node '{platform.node()}' has {difference}")
    place = _place(files)
    jobs = [place.here(request, number) for number, (_, request) in enumerate(batch.cases)]
    results: list[tuple[int, CaseResult, bytes]] = []
    for number, result in run_isolated(jobs, place.server, hard_cap=batch.hard_cap):
        index, request = batch.cases[number]
        results.append((index, place.as_sent(request, jobs[number], result), _packed(result)))
        shutil.rmtree(place.report(number), ignore_errors=True)  # it is packed
    return BatchResult(tuple(results), "", processor_family(), time.monotonic() - begin)


class _Place:
    """A folder with the files of a suite as they were on the sending machine, and a fork server.

    Attributes:
        server: A fork server whose working directory is inside the folder.
    """

    def __init__(self, files: Files) -> None:
        self.key = files.key
        self._root = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-"))
        self._sent_from = files.folder
        self.server = WarmServer()
        folder = self._inside(files.folder)
        folder.mkdir(parents=True)
        for path, content in files.contents.items():
            target = self._inside(path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        os.environ.update(
            {
                name: value if name not in files.contents else str(self._inside(value))
                for name, value in files.environment.items()
            }
        )
        os.chdir(folder)  # the fork server begins here

    def close(self) -> None:
        """End the fork server and remove the files."""
        self.server.close()
        shutil.rmtree(self._root, ignore_errors=True)

    def _inside(self, path: str) -> Path:
        return self._root / path.lstrip("/")

    def report(self, number: int) -> Path:
        """The folder of a report, until it is packed."""
        return self._root / "reports" / str(number)

    def here(self, request: RunRequest, number: int) -> RunRequest:
        """A request with the paths of this machine; the scenario's is relative to its folder."""
        file = Path(os.path.relpath(Path(self._sent_from) / request.file, self._sent_from))
        report = None if request.report_dir is None else self.report(number)
        return replace(request, file=file, report_dir=report)

    def as_sent(self, request: RunRequest, here: RunRequest, result: CaseResult) -> CaseResult:
        """A result with the paths of the sending machine."""
        text = json.dumps(to_plain(result)).replace(json.dumps(str(self._root))[1:-1], "")
        plain: dict[str, Any] = json.loads(text)
        for problem in plain["problems"]:
            if problem["path"] == str(here.file):
                problem["path"] = str(request.file)
        sent = result_of({**plain, "file": str(request.file)})
        report = "" if not result.report_dir else str(request.report_dir)
        page = "" if not result.page else str(Path(report) / Path(result.page).name)
        return replace(sent, report_dir=report, page=page)


_places: list[_Place] = []


def _place(files: Files) -> _Place:
    """The place of these files in this process; that of other files is closed."""
    if _places and _places[0].key != files.key:
        _close_places()
    if not _places:
        remove_abandoned(PREFIX)
        atexit.register(_close_places)
        _places.append(_Place(files))
    return _places[0]


def _close_places() -> None:
    while _places:
        _places.pop().close()


def _packed(result: CaseResult) -> bytes:
    """The report of a case as an archive; nothing where it has none."""
    if not result.report_dir:
        return b""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        archive.add(result.report_dir, arcname=".")
    return buffer.getvalue()


def unpack_report(packed: bytes, folder: Path) -> None:
    """Write a packed report into its folder, whole or not at all.

    Raises:
        OSError: The folder cannot be written.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = folder.with_name(f".{folder.name}.writing.{os.getpid()}.0")
    try:
        with tarfile.open(fileobj=io.BytesIO(packed), mode="r:gz") as archive:
            archive.extractall(part, filter="data")
        shutil.rmtree(folder, ignore_errors=True)
        part.rename(folder)
    finally:
        shutil.rmtree(part, ignore_errors=True)
