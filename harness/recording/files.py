"""Pictures and videos of a run: encoded files by their path in the run's folder."""

from __future__ import annotations

import errno
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath

from harness.core.errors import Problem, SpecError
from harness.core.files import read_at_most, write_whole
from harness.core.limits import PICTURE_FILE, PICTURE_PIXELS

OTHERS = (".mp4", ".webm", ".npz")  # files of cameras that are no pictures


class FolderFiles(Mapping[str, bytes]):
    """Files of a saved run, read on first use."""

    def __init__(self, folder: Path, names: Iterable[str]) -> None:
        self._folder = folder
        self._names = dict.fromkeys(names)

    def __getitem__(self, name: str) -> bytes:
        if name not in self._names:
            raise KeyError(name)
        from harness.core.picture_files import pixels_of  # Pillow takes time

        path = self._folder / name
        try:
            if not (self._folder / checked(name)).resolve().is_relative_to(self._folder.resolve()):
                raise _damaged(path, "this file leads out of the run's folder")
            content = read_at_most(path, PICTURE_FILE)
            if path.suffix in OTHERS or pixels_of(content) <= PICTURE_PIXELS:
                return content
        except ValueError as error:
            raise _damaged(path, str(error)) from error
        except OSError as error:
            raise _damaged(path, f"cannot be read: {error.strerror or error}") from error
        raise _damaged(path, f"it has more than {PICTURE_PIXELS:,} pixels")

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write every file below a folder, in order of their names."""
    for name in sorted(files):
        path = folder / checked(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(files[name])


def write_file(path: Path, content: bytes | str) -> None:
    """Write a file of a saved run whole, in place of a link, which may lead anywhere, or a pipe."""
    if path.is_symlink() or path.is_fifo():
        path.unlink()
    write_whole(path, content)


def disk_advice(error: OSError) -> str:
    """The beginning of the advice on a file that cannot be written."""
    full = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    return "free some space there, or " if error.errno in full else ""


def checked(name: str) -> str:
    """The name, if it stays below the folder it is relative to.

    Raises:
        ValueError: It does not.
    """
    parts = PurePosixPath(name).parts
    if not parts or name.startswith("/") or ".." in parts or "\\" in name or "\0" in name:
        raise ValueError(f"'{name}' is no path inside a run's folder")
    return name


def _damaged(path: Path, reason: str) -> SpecError:
    return SpecError([Problem(str(path), 0, 0, f"damaged run: {reason}")])
