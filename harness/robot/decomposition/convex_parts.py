"""Convex parts of meshes, kept in the user's cache directory by the content of the mesh."""

from __future__ import annotations

import hashlib
import io
import platform
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from harness.core.errors import MissingPackage
from harness.core.extras import missing_extra
from harness.core.types import FloatArray
from harness.core.user_cache import cached, store

METHOD = 5  # Version of the decomposition; parts of another version are computed again


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Convex parts of a mesh.

    Attributes:
        hull: The corners of the convex hull of the whole mesh, shape (N, 3) [m].
        parts: Points whose convex hulls are the parts, each of shape (N, 3) [m].
        excess: The largest distance of a point of a part from the mesh [m].
        hull_excess: The same for the convex hull of the whole mesh [m].
    """

    hull: FloatArray
    parts: tuple[FloatArray, ...]
    excess: float
    hull_excess: float


def stored_decomposition(
    content: bytes, factors: FloatArray, triangles: Callable[[], FloatArray], *, is_hull: bool
) -> Decomposition:
    """The convex parts of a mesh; computed where the cache does not have them.

    The key holds everything that the parts depend on, the versions of the numerical libraries
    included, so that it makes no difference whether they were stored.

    Args:
        content: The bytes of the mesh file.
        factors: The factors from its coordinates to metres, shape (3,).
        triangles: Reads the corners [m], shape (M, 3, 3).
        is_hull: Whether the hull is the only part in any case.
    """
    try:
        versions = _versions()
    except PackageNotFoundError as error:
        raise MissingPackage(f"convex parts cannot be computed: {missing_extra(error)}") from error
    key = hashlib.sha256(content)
    key.update(repr((factors.tolist(), METHOD, *versions)).encode())
    name = f"convex_{'hulls' if is_hull else 'parts'}/{key.hexdigest()}.npz"
    stored = cached(name)
    if stored is not None:
        return _read(stored)
    try:
        from harness.robot.decomposition.decomposition import decompose  # here: imports SciPy
    except ModuleNotFoundError as error:
        raise MissingPackage(f"convex parts cannot be computed: {missing_extra(error)}") from error
    found = decompose(triangles(), is_hull=is_hull)
    store(name, _content(found))
    return found


@cache
def _versions() -> tuple[str, ...]:
    return np.__version__, version("scipy"), platform.machine()


def _read(content: bytes) -> Decomposition:
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        hull, points, ends = arrays["hull"], arrays["points"], arrays["ends"]
        excess, hull_excess = arrays["measures"].tolist()
    parts = tuple(np.split(points, ends[:-1]))
    return Decomposition(hull, parts, excess, hull_excess)


def _content(found: Decomposition) -> bytes:
    content = io.BytesIO()
    np.savez(
        content,
        hull=found.hull,
        points=np.concatenate(found.parts),
        ends=np.cumsum([len(part) for part in found.parts]),
        measures=np.array([found.excess, found.hull_excess]),
    )
    return content.getvalue()
