"""Convex parts of meshes, kept in the user's cache directory by the content of the mesh."""

from __future__ import annotations

import hashlib
import io
import platform
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import ClassVar

import numpy as np

from harness.core.errors import MissingPackage
from harness.core.extras import missing_extra
from harness.core.registry import Plugin, absent_plugins, registry
from harness.core.types import FloatArray
from harness.core.user_cache import cached, store


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


class Decomposer(Plugin, ABC):
    """How a mesh becomes convex parts; the first one that is registered is used.

    Attributes:
        version: Changes with the parts that it computes; stored parts of another version are not
            used.
    """

    plugin_kind: ClassVar[str] = "decomposer"
    version: ClassVar[int] = 1

    @abstractmethod
    def decompose(self, triangles: FloatArray, *, is_hull: bool) -> Decomposition:
        """Compute the parts of a mesh.

        Args:
            triangles: Corners [m], shape (M, 3, 3); they need not be connected or closed.

        Raises:
            ModuleNotFoundError: A package is not installed.
            ValueError: The mesh has no convex hull.
        """


def stored_decomposition(
    content: bytes, factors: FloatArray, triangles: Callable[[], FloatArray], *, is_hull: bool
) -> Decomposition:
    """The convex parts of a mesh; computed where the cache does not have them.

    The key holds everything that the parts depend on, the versions of the numerical libraries
    included, so that it makes no difference whether they were stored.

    Args:
        factors: The factors from its coordinates to metres, shape (3,).
        triangles: Reads the corners [m], shape (M, 3, 3).
        is_hull: Whether the hull is the only part in any case.

    Raises:
        MissingPackage: A package, or every decomposer, is not installed.
    """
    decomposer = next(iter(registry(Decomposer.plugin_kind).values()), None)
    if decomposer is None:
        why = "; ".join(["no plug-in computes them", *absent_plugins()])
        raise MissingPackage(f"convex parts cannot be computed: {why}")
    try:
        versions = _versions()
    except PackageNotFoundError as error:
        raise MissingPackage(f"convex parts cannot be computed: {missing_extra(error)}") from error
    key = hashlib.sha256(content)
    key.update(repr((factors.tolist(), decomposer.version, *versions)).encode())
    name = f"convex_{'hulls' if is_hull else 'parts'}/{key.hexdigest()}.npz"
    stored = cached(name)
    if stored is not None:
        return _read(stored)
    try:
        found = decomposer().decompose(triangles(), is_hull=is_hull)
    except ModuleNotFoundError as error:
        raise MissingPackage(f"convex parts cannot be computed: {missing_extra(error)}") from error
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
