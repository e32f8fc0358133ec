"""Keeps the convex parts of meshes in the user's cache directory, by the content of the mesh."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import tempfile
import zipfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import numpy as np

from harness.core.types import FloatArray
from harness.robot.decomposition.convex_parts import Decomposition

METHOD = 1
"""Version of the decomposition; parts of another version are computed again."""


def cache_folder() -> Path:
    """The folder of the parts: `armharness/convex_parts` in XDG's cache directory."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if Path(base).is_absolute() else Path.home() / ".cache"
    return root / "armharness" / "convex_parts"


def stored_decomposition(
    content: bytes, factors: FloatArray, triangles: Callable[[], FloatArray]
) -> Decomposition:
    """The convex parts of a mesh; computed where the cache does not have them.

    The key holds everything that the parts depend on, the versions of the numerical libraries
    included, so that it makes no difference whether they were stored.

    Args:
        content: The bytes of the mesh file.
        factors: The factors from its coordinates to metres, shape (3,).
        triangles: Reads the corners [m], shape (M, 3, 3).
    """
    key = hashlib.sha256(content)
    versions = (METHOD, np.__version__, version("scipy"), platform.machine())
    key.update(repr((factors.tolist(), *versions)).encode())
    path = cache_folder() / f"{key.hexdigest()}.npz"
    found = _read(path)
    if found is None:
        from harness.robot.decomposition.decomposition import decompose  # here: imports SciPy

        found = decompose(triangles())
        _write(path, found)
    return found


def _read(path: Path) -> Decomposition | None:
    """What is stored; None where nothing is, or it is damaged."""
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as arrays:
            points, ends = arrays["points"], arrays["ends"]
            excess, hull_excess, is_closed = arrays["measures"].tolist()
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    parts = tuple(np.split(points, ends[:-1]))
    return Decomposition(parts, excess, hull_excess, bool(is_closed))


def _write(path: Path, found: Decomposition) -> None:
    """Store under a temporary name, then rename: a reader never sees half a file."""
    content = io.BytesIO()
    np.savez(
        content,
        points=np.concatenate(found.parts),
        ends=np.cumsum([len(part) for part in found.parts]),
        measures=np.array([found.excess, found.hull_excess, float(found.is_closed)]),
    )
    temporary = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content.getbuffer())
        Path(temporary).replace(path)
    except OSError:  # a full or read-only disk: the parts are computed again next time
        if temporary:
            Path(temporary).unlink(missing_ok=True)
