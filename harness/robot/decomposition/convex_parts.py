"""The result of a convex decomposition."""

from __future__ import annotations

from dataclasses import dataclass

from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Convex parts of a mesh.

    Attributes:
        hull: The corners of the convex hull of the whole mesh, shape (N, 3) [m].
        parts: Points whose convex hulls are the parts, each of shape (N, 3) [m].
        excess: The largest distance of a point of a part from the mesh [m].
        hull_excess: The same for the convex hull of the whole mesh [m].
        is_closed: Whether the mesh encloses a volume.
    """

    hull: FloatArray
    parts: tuple[FloatArray, ...]
    excess: float
    hull_excess: float
    is_closed: bool
