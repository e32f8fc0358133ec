"""NumPy's .npz files, read within bounds: every header is checked before an array is loaded."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

from harness.core.files import open_regular
from harness.core.limits import RUN_ARRAYS

Array = np.ndarray[Any, Any]
SUFFIX = ".npy"


class NpzError(ValueError):
    """A file is no .npz, or an array in it cannot be read.

    Attributes:
        key: Name of the array; empty when it is the file.
    """

    def __init__(self, key: str, reason: str) -> None:
        self.key, self.reason = key, reason
        super().__init__(f"{key}: {reason}" if key else reason)


@dataclass(frozen=True)
class ArrayHeader:
    """What an array is, before it is loaded."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def size(self) -> int:
        """Size when it is unpacked [bytes]."""
        return math.prod(self.shape) * self.dtype.itemsize


class NpzFile:
    """An open .npz file.

    Opening reads the headers alone. Arrays that hold pickled objects are refused, and so is a file
    whose arrays take more than `most` bytes, whatever their compressed size.

    Raises:
        NpzError: The file is damaged, too large or no .npz; carries the array's name.
        OSError: It cannot be opened.
    """

    def __init__(self, file: Path | BinaryIO, most: int = RUN_ARRAYS) -> None:
        stream = open_regular(file) if isinstance(file, Path) else file
        try:
            with _located(""):
                self._archive = zipfile.ZipFile(stream)
            self.headers = dict(self._headers(most))
        except BaseException:
            stream.close()
            raise
        self._stream = stream

    def __enter__(self) -> NpzFile:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()

    def read(self, name: str) -> Array:
        """An array.

        Raises:
            NpzError: Its data are damaged.
        """
        with _located(name), self._archive.open(f"{name}{SUFFIX}") as member:
            array: Array = np.lib.format.read_array(member, allow_pickle=False)
            if member.read(1):
                raise NpzError(name, "more data than its header says")
        return array

    def _headers(self, most: int) -> Iterator[tuple[str, ArrayHeader]]:
        seen: set[str] = set()
        total = sum(entry.file_size for entry in self._archive.infolist())
        if total > most:
            raise NpzError("", f"its arrays take {total} bytes; at most {most} are read")
        for entry in self._archive.infolist():
            name = entry.filename.removesuffix(SUFFIX)
            if name in seen:
                raise NpzError(name, "it is there twice")
            seen.add(name)
            with _located(name), self._archive.open(entry) as member:
                header = _header(member)
                data = entry.file_size - member.tell()
            if header.dtype.hasobject:
                raise NpzError(name, "pickled objects are not loaded; expected numbers")
            if min(header.shape, default=0) < 0 or header.size != data:
                raise NpzError(
                    name,
                    f"{data} bytes of data; its header says {header.dtype} of shape {header.shape}",
                )
            yield name, header


def _header(member: IO[bytes]) -> ArrayHeader:
    is_first = np.lib.format.read_magic(member) == (1, 0)
    form = np.lib.format
    read = form.read_array_header_1_0 if is_first else form.read_array_header_2_0
    shape, _, dtype = read(member)
    return ArrayHeader(shape, dtype)


@contextmanager
def _located(name: str) -> Generator[None]:
    """Whatever zipfile, zlib and NumPy raise on damaged bytes, as one error with the key."""
    try:
        yield
    except NpzError:
        raise
    except Exception as error:
        raise NpzError(name, str(error) or type(error).__name__) from error
