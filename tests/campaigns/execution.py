"""Changed files that are read in this process, one after another, and how each ended."""

from __future__ import annotations

import hashlib
import json
import mmap
import os
import resource
import struct
import time
import traceback
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from random import Random
from tempfile import mkdtemp

from harness.core.errors import HarnessError, SpecError
from tests.campaigns import mutation
from tests.campaigns.reader import Read, Reader

FEW = 50  # the fewest executions of a campaign
EVERY = 1.0  # wall time after which the counts are written again [s]
LARGEST = 8 * 2**20  # bytes of an input; good files have at most a megabyte
HEAD = struct.Struct("<QQ")  # number of executions, and bytes of the input


@dataclass
class Outcome:
    """What the campaign of one reader gave.

    Attributes:
        refused: Executions that ended in a located error.
        seconds: Processor time, which a busy machine does not lengthen.
        findings: Kinds of bad ends, by the place in the program that raised.
    """

    executions: int = 0
    refused: int = 0
    seconds: float = 0.0
    peak_megabytes: int = 0
    findings: dict[str, str] = field(default_factory=dict[str, str])


class LastInput:
    """The input that is read now, where another process finds it after a crash."""

    def __init__(self, path: Path) -> None:
        if not path.exists():
            path.write_bytes(bytes(HEAD.size + LARGEST))
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), HEAD.size + LARGEST)

    def write(self, number: int, data: bytes) -> None:
        """Keep an input and its number."""
        self._memory[: HEAD.size] = HEAD.pack(number, len(data))
        self._memory[HEAD.size : HEAD.size + len(data)] = data

    def number(self) -> int:
        """How many inputs were written."""
        return HEAD.unpack_from(self._memory)[0]

    def data(self) -> bytes:
        """The input."""
        return self._memory[HEAD.size : HEAD.size + HEAD.unpack_from(self._memory)[1]]


class Execution:
    """A reader in this process; counts what it does, in a folder that outlives a crash."""

    def __init__(self, reader: Reader, folder: Path, outcome: Outcome) -> None:
        self._reader, self._folder, self.outcome = reader, folder, outcome
        self._place = Path(mkdtemp(prefix="changed-", dir=folder))
        corpus = list(reader.corpus(Path(mkdtemp(prefix="good-", dir=folder))))
        self._read = reader.begin(self._place)
        self.corpus = [data for data in corpus if is_good(self._read, self._place, data)]
        assert self.corpus, "no file is read as it is"
        self._names = {self.name_of(data) for data in self.corpus} if reader.is_named else {b""}
        self._last = LastInput(folder / "last")
        self._saved, self._begin = time.monotonic(), processor_time()

    def name_of(self, data: bytes) -> bytes:
        """What stays of a file that is changed."""
        name, colon, _ = data.partition(b":")
        return name + colon if self._reader.is_named else b""

    def changed(self, corpus: Sequence[bytes], rng: Random) -> bytes:
        """A changed file; one that is no document any more is changed as bytes."""
        try:
            return self._reader.mutate(corpus, rng)[:LARGEST]
        except Exception:  # noqa: BLE001 - XML that is not well-formed, YAML that is no tree, ...
            name = self.name_of(corpus[0])
            return name + mutation.of_bytes([corpus[0][len(name) :]], rng)[:LARGEST]

    def execute(self, data: bytes) -> None:
        """Read a file; each end but a located error is a finding."""
        outcome = self.outcome
        if self.name_of(data) not in self._names:
            return
        outcome.executions += 1
        self._last.write(outcome.executions, data)
        try:
            outcome.refused += not reads(self._read, self._place, data)
        except Exception as error:  # noqa: BLE001 - each other end is a finding
            key = place_of(error)
            if key not in outcome.findings:
                outcome.findings[key] = f"{type(error).__name__}: {error}"[:300]
                keep(self._folder, key, data, "".join(traceback.format_exception(error)[-12:]))
        if time.monotonic() > self._saved + EVERY:
            self.save()

    def save(self) -> None:
        """Write the counts so far."""
        self._saved = time.monotonic()
        self.outcome.seconds = round(processor_time() - self._begin, 1)
        self.outcome.peak_megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        part = self._folder / "outcome.part"
        part.write_text(json.dumps(asdict(self.outcome)))
        part.replace(self._folder / "outcome.json")

    def search(self, seed: int, seconds: float) -> None:
        """Change and read good files for some seconds, and a few at least."""
        rng, end = Random(seed), time.monotonic() + seconds
        while self.outcome.executions < FEW or time.monotonic() < end:
            self.execute(self.changed(self.corpus, rng))
        self.save()


def processor_time() -> float:
    """Processor time of this process and the processes that it has ended [s]."""
    return sum(os.times()[:4])


def reads(read: Read, place: Path, data: bytes) -> bool:
    """Whether a changed file is read; one that is refused says where the mistake is."""
    try:
        read(place, data)
    except HarnessError as error:
        problems = error.problems if isinstance(error, SpecError) else []
        if not str(error) or not all(each.path and str(each) for each in problems):
            raise RuntimeError(f"not located: {error}") from error
        return False
    return True


def is_good(read: Read, place: Path, data: bytes) -> bool:
    """Whether a file is read before it is changed; some lack files next to them."""
    try:
        read(place, data)
    except HarnessError:
        return False
    return True


def place_of(error: BaseException) -> str:
    """The kind of an error: its type, and the innermost line of the program."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [each for each in frames if f"{os.sep}harness{os.sep}" in each.filename]
    last = (own or frames)[-1]
    return f"{type(error).__name__} at {Path(last.filename).name}:{last.lineno} in {last.name}"


def keep(folder: Path, key: str, data: bytes, shown: str) -> None:
    """Write an input that ended badly next to its traceback."""
    name = hashlib.sha256(key.encode()).hexdigest()[:12]
    (folder / f"finding-{name}").write_bytes(data)
    (folder / f"finding-{name}.txt").write_text(f"{key}\n{shown}", errors="replace")
