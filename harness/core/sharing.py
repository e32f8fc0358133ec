"""Results that the cases of one command share: each is computed once for the same inputs.

A process that forks the cases opens a folder; its children keep results there, by keys that hold
every byte of the inputs (`exact_key`), and take them from there. A result that is taken is the
result that would be computed, so that sharing changes no digest. Without a folder, everything is
computed.
"""

from __future__ import annotations

import os
import pickle
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from harness.core.exact_key import NoKeyError, exact_key
from harness.core.files import replaced

PREFIX = "harness-shared-"
"""How the names of folders begin; the number of the process that owns it follows."""

MOST_BYTES = 128 * 2**20
"""Size of the results that are kept; the least recently used ones make room."""

MOST_RESULTS = 4096
"""Number of results that are kept."""

LOOK_EVERY = 64
"""Results that are kept, approximately, until a process looks again whether there is room."""

T = TypeVar("T")


@dataclass
class SharedTally:
    """How many results of each kind a case took from others, and how many it computed."""

    taken: Counter[str] = field(default_factory=Counter[str])
    computed: Counter[str] = field(default_factory=Counter[str])

    def counts(self) -> dict[str, tuple[int, int]]:
        """How many results of each kind were taken, and how many there are."""
        kinds = sorted({*self.taken, *self.computed})
        return {kind: (self.taken[kind], self.taken[kind] + self.computed[kind]) for kind in kinds}


class SharedResults:
    """Results in a folder, by key.

    Attributes:
        folder: The folder, which only this user can read.
        tally: What was taken and what was computed since `begin`.
    """

    def __init__(self, folder: Path, most_bytes: int = MOST_BYTES) -> None:
        self.folder = folder
        self.tally = SharedTally()
        self._folder = str(folder)
        self._most_bytes = most_bytes
        self._kept = 0

    def find(self, key: str) -> Any:
        """The result of a key; None where there is none."""
        path = f"{self._folder}/{key}"
        try:
            with open(path, "rb") as file:  # noqa: PTH123 - thousands of times in a case
                found = pickle.load(file)
            os.utime(path)
        except (OSError, EOFError, pickle.UnpicklingError):
            return None
        return found

    def keep(self, key: str, result: object) -> None:
        """Keep a result, if there is room on the disk."""
        with suppress(OSError):
            with replaced(self.folder / key) as file:
                pickle.dump(result, file, pickle.HIGHEST_PROTOCOL)
            self._kept += 1
            if (os.getpid() + self._kept) % LOOK_EVERY == 0:  # in some of the processes at least
                self._make_room()

    def was_seen(self, key: str) -> bool:
        """Whether a case has computed the result of a key before; from now on it has."""
        path = self.folder / f"seen-{key}"
        if path.exists():
            return True
        with suppress(OSError):
            path.touch()
        return False

    def _make_room(self) -> None:
        with os.scandir(self.folder) as entries:
            found = [(each.stat(), Path(each.path)) for each in entries]
        found.sort(key=lambda each: -each[0].st_mtime_ns)
        size = 0
        for number, (stat, path) in enumerate(found):
            size += stat.st_size
            if size > self._most_bytes or number >= MOST_RESULTS:
                path.unlink(missing_ok=True)


class KeyChain:
    """Results of one case that follow from each other, such as the parts of a motion.

    A chain is kept from a result on that a second case computes, so that results which are
    different in every case are not.
    """

    def __init__(self, results: SharedResults, kind: str) -> None:
        self._results = results
        self._kind = kind
        self._keeps = False
        self.is_over = False

    def find(self, key: str) -> Any:
        """What is known under a key; None where that is nothing, or the chain is over."""
        return None if self.is_over else self._results.find(key)

    def take(self, amount: int) -> None:
        """Count what was taken of a result that was found."""
        self._results.tally.taken[self._kind] += amount

    def note(self, amount: int) -> None:
        """Count what was computed and is not kept."""
        self._results.tally.computed[self._kind] += amount

    def keep(self, key: str, known: Callable[[], object], amount: int, variant: str) -> None:
        """Keep what is known under a key; the chain is over at the first result of its own.

        Args:
            key: The key that others look for.
            known: Returns what they find.
            amount: What the result that was computed counts.
            variant: Key of what a result follows from besides.
        """
        self.note(amount)
        is_kept = self._keeps or (not self.is_over and self._results.was_seen(key + variant))
        self._keeps = is_kept
        if is_kept:
            self._results.keep(key, known())
        else:
            self.is_over = True


_shared: SharedResults | None = None


def open_folder() -> Path:
    """Let this process, and those that it forks from now on, share results in a folder."""
    global _shared
    if _shared is None:
        _shared = SharedResults(Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-")))
    return _shared.folder


def close_folder() -> None:
    """Remove the folder."""
    global _shared
    if _shared is not None:
        shutil.rmtree(_shared.folder, ignore_errors=True)
        _shared = None


def begin(*, share: bool = True) -> SharedTally:
    """Begin a case in this process, which takes nothing from others unless it may share.

    Returns:
        What the case takes and computes from here on; nothing where nothing is shared.
    """
    global _shared
    tally = SharedTally()
    if not share:
        _shared = None
    if _shared is not None:
        _shared.tally = tally
    return tally


def is_sharing() -> bool:
    """Whether this process shares results with others."""
    return _shared is not None


def chain(kind: str) -> KeyChain | None:
    """A chain of results of a kind; None where nothing is shared."""
    return None if _shared is None else KeyChain(_shared, kind)


def was_seen(*inputs: object) -> bool:
    """Whether a case had the same inputs before; not where nothing is shared."""
    try:
        return _shared is not None and _shared.was_seen(exact_key(*inputs))
    except NoKeyError:
        return False


def shared(
    kind: str,
    inputs: Callable[[], tuple[object, ...]],
    compute: Callable[[], T],
    *,
    is_often_needed: bool = True,
    may_be_known: bool = True,
) -> T:
    """The result of a computation, from a case that had the same inputs or computed here.

    Args:
        kind: What the result is; a part of its key.
        inputs: Everything that the result follows from; called only where results are shared.
        compute: A pure function of the inputs, whose result can be pickled.
        is_often_needed: Whether the first case keeps the result; else the second one that has the
            same inputs does, which costs less where most inputs are different in every case.
        may_be_known: Whether the result is looked up, and kept for others.
    """
    if _shared is None:
        return compute()
    if not may_be_known:
        _shared.tally.computed[kind] += 1
        return compute()
    try:
        key = exact_key(kind, *inputs())
    except NoKeyError:
        return compute()
    found = _shared.find(key)
    if found is not None:
        _shared.tally.taken[kind] += 1
        return found
    result = compute()
    _shared.tally.computed[kind] += 1
    if is_often_needed or _shared.was_seen(key):
        _shared.keep(key, result)
    return result
