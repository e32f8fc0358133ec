"""Files in the user's cache directory: what is computed once and is the same for every run."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def cache_folder() -> Path:
    """The folder `armharness` in XDG's cache directory."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if Path(base).is_absolute() else Path.home() / ".cache"
    return root / "armharness"


def cached(name: str) -> bytes | None:
    """The content of a stored file; None where there is none."""
    try:
        return (cache_folder() / name).read_bytes()
    except OSError:
        return None


def is_writable() -> bool:
    """Whether `store` can keep files."""
    folder = cache_folder()
    there = next(each for each in (folder, *folder.parents) if each.exists())
    return os.access(there, os.W_OK)


def store(name: str, content: bytes) -> None:
    """Store under a temporary name, then rename: a reader never sees half a file.

    A full or read-only disk is no error: the content is computed again next time.
    """
    path, temporary = cache_folder() / name, ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(temporary).replace(path)
    except OSError:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
