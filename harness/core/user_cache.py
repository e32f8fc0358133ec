"""Files in the user's cache directory: what is computed once and is the same for every run."""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from pathlib import Path

from harness.core.files import home_folder, write_whole

LARGEST = 1_000_000_000  # [bytes], of the folder: files that were not read for longest go

_CHECKSUM = hashlib.sha256().digest_size


def cache_folder() -> Path:
    """The folder `armharness` in XDG's cache directory; none can be there without a home folder."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    home = home_folder() or Path(os.devnull)
    return (Path(base) if Path(base).is_absolute() else home / ".cache") / "armharness"


def cached(name: str) -> bytes | None:
    """The content of a stored file; None where there is none, or it is damaged."""
    path = cache_folder() / name
    try:
        stored = path.read_bytes()
    except OSError:
        return None
    with suppress(OSError):  # of another user
        os.utime(path)
    checksum, content = stored[:_CHECKSUM], stored[_CHECKSUM:]
    return content if hashlib.sha256(content).digest() == checksum else None


def store(name: str, content: bytes) -> None:
    """Store a file whole, with a checksum at its beginning.

    A full or read-only disk is no error: the content is computed again next time.
    """
    path = cache_folder() / name
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, hashlib.sha256(content).digest() + content)
        _remove_oldest()


def _remove_oldest() -> None:
    """Keep the folder within `LARGEST`; processes that read a removed file read all of it."""
    files = [(path.stat(), path) for path in cache_folder().rglob("*") if path.is_file()]
    excess = sum(status.st_size for status, _ in files) - LARGEST
    for status, path in sorted(files, key=lambda file: file[0].st_mtime_ns):
        if excess <= 0:
            break
        path.unlink(missing_ok=True)
        excess -= status.st_size
