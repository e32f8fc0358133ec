"""Files that are written whole, or stay as they were."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from harness.core.errors import HarnessError

BUFFER = 2**20  # bytes of a file that are written at once


def is_file(path: Path) -> bool:
    """Whether a file is there; not where the path cannot be one, as its name is too long."""
    return os.path.isfile(path)  # noqa: PTH113 - `Path.is_file` raises OSError for such a name


def is_dir(path: Path) -> bool:
    """Whether a folder is there; not where the path cannot be one, as its name is too long."""
    return os.path.isdir(path)  # noqa: PTH112 - as above


def path_exists(path: Path) -> bool:
    """Whether a file or folder is there; not where the path cannot be one."""
    return os.path.exists(path)  # noqa: PTH110 - as above


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
    status = path.stat()
    if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
        raise OSError(errno.EINVAL, "not a regular file", str(path))
    if status.st_size > most:
        reason = f"{status.st_size / 1e6:.0f} MB; at most {most / 1e6:.0f} MB are read"
        raise OSError(errno.EFBIG, reason, str(path))
    return path.read_bytes()


def part_of(file: Path) -> Path:
    """The file that is written first, and then renamed."""
    return file.with_name(f".{file.name}.{os.getpid()}")


@contextmanager
def replaced(file: Path) -> Generator[IO[bytes]]:
    """A new file, which gets its name when everything is written.

    A link stays one, and its target is replaced. What is no file, such as a pipe or a device, is
    written to.
    """
    if file.exists() and not file.is_file():
        with file.open("wb") as stream:
            yield stream
        return
    file = file.resolve()
    part = part_of(file)
    try:
        with part.open("wb", buffering=BUFFER) as stream:
            yield stream
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)


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
