"""Files that are written whole, or stay as they were."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Generator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path
from typing import IO

from harness.core.errors import HarnessError

BUFFER = 2**20  # bytes of a file that are written at once
WRITTEN_NOW = os.O_WRONLY | os.O_NONBLOCK  # an error for a pipe without a reader

is_file, is_dir, path_exists = os.path.isfile, os.path.isdir, os.path.exists
"""What is there; nothing where a name is too long, for which `Path.is_file` raises OSError."""


def home_folder() -> Path | None:
    """The user's home folder; None where neither HOME nor an entry of the user names one."""
    try:
        return Path.home()
    except RuntimeError:
        return None


def expanded(path: str | Path) -> Path:
    """A path with `~` replaced, as far as that names the home folder of a user."""
    try:
        return Path(path).expanduser()
    except RuntimeError:
        return Path(path)


def read_at_most(path: Path, most: int) -> bytes:
    """The bytes of a file that anybody may have written.

    Args:
        most: The largest size [bytes].

    Raises:
        OSError: It cannot be read, is no regular file, or is larger.
    """
    with open_regular(path) as stream:
        size = os.fstat(stream.fileno()).st_size
        if size > most:
            reason = f"{size / 1e6:.0f} MB; at most {most / 1e6:.0f} MB are read"
            raise OSError(errno.EFBIG, reason, str(path))
        return stream.read() or b""  # None of a file of the kernel that would be waited for


def open_regular(path: Path) -> BufferedReader:
    """Open a file for reading; an OSError for a pipe, whose writer would be waited for."""
    stream = open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK))  # noqa: SIM115
    if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
        stream.close()
        raise OSError(errno.EINVAL, "not a regular file", str(path))
    return stream


def part_of(file: Path) -> Path:
    """The file that is written first, and then renamed."""
    return file.with_name(f".{file.name}.{os.getpid()}")


@contextmanager
def replaced(file: Path) -> Generator[IO[bytes]]:
    """A new file, which gets its name when everything is written.

    A link stays one, and its target is replaced. What is no file, such as a device or a pipe that
    somebody reads, is written to.
    """
    if file.exists() and not file.is_file():
        with open(file, "wb", opener=lambda name, _: os.open(name, WRITTEN_NOW)) as stream:
            os.set_blocking(stream.fileno(), True)
            yield stream
        return
    file = file.resolve()
    part = part_of(file)
    try:
        with part.open("wb", buffering=BUFFER) as stream:
            yield stream
        part.replace(file)
    except OSError as error:
        if error.filename in (None, str(part)):  # a full disk names none
            error.filename = str(file)
        raise
    finally:
        part.unlink(missing_ok=True)


def write_whole(file: Path, content: bytes | str) -> None:
    """Write a file, a text as UTF-8, or leave it as it was."""
    with replaced(file) as stream:
        stream.write(content.encode() if isinstance(content, str) else content)


@contextmanager
def writing(folder: Path) -> Generator[None]:
    """Make a folder, and report that files in it cannot be written.

    Raises:
        HarnessError: A file cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        raise HarnessError(f"'{folder}' cannot be written: {error.strerror}") from error
