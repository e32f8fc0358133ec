"""One kind of input of a campaign, and what several kinds share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.core.resources import data_folder
from tests.campaigns import mutation
from tests.campaigns.mutation import Mutate

Read = Callable[[Path, bytes], None]
"""Reads a changed file in a folder; raises a HarnessError where it refuses it."""


@dataclass(frozen=True)
class Reader:
    """One kind of input.

    Attributes:
        corpus: Gives good files; called once, in an empty folder.
        mutate: Changes one.
        begin: Makes what reads a changed file; called once, in the process that reads.
        is_named: The data is `NAME:CONTENT`; names stay as they are.
    """

    corpus: Callable[[Path], Sequence[bytes]]
    mutate: Mutate
    begin: Callable[[Path], Read]
    is_named: bool = False


def bundled(kind: str, pattern: str) -> list[bytes]:
    """All bundled files of a kind whose names fit a pattern."""
    found = [path.read_bytes() for path in sorted(data_folder(kind).rglob(pattern))]
    assert found, (kind, pattern)
    return found


def put(folder: Path, name: str, data: bytes) -> Path:
    """Write a file; its path."""
    path = folder / name
    path.write_bytes(data)
    return path


def of_file(name: str, read: Callable[[Path], object]) -> Callable[[Path], Read]:
    """What reads one file of a name."""

    def begin(_: Path) -> Read:
        return lambda folder, data: void(read(put(folder, name, data)))

    return begin


def of_data(read: Callable[[bytes], object]) -> Callable[[Path], Read]:
    """What reads data that is in no file."""

    def begin(_: Path) -> Read:
        return lambda _folder, data: void(read(data))

    return begin


def void(_: object) -> None:
    """Nothing, of a call whose result is not needed."""


def text_of(data: bytes) -> str:
    """A text, whatever its bytes are."""
    return data.decode("utf-8", errors="replace")


def after_its_name(mutate: Mutate) -> Mutate:
    """What changes the content of `NAME:CONTENT`, and leaves the name as it is."""

    def changed(corpus: Sequence[bytes], rng: mutation.Random) -> bytes:
        name, _, content = rng.choice(corpus).partition(b":")
        return name + b":" + mutate([content], rng)

    return changed
