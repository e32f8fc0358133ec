"""Triangles of one colour, coarse enough to draw quickly without a graphics card."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.geometry import Rgba
from harness.core.types import FloatArray, IntArray

GRID = 0.002
"""Size of the cells in which vertices merge [m]: about a pixel in a picture of an arm."""


@dataclass(frozen=True, eq=False)
class MeshPart:
    """Triangles of one colour.

    Attributes:
        vertices: The vertices, shape (V, 3) [m].
        faces: The faces as indices of vertices, shape (F, 3).
        rgba: None where the file gives no colour.
    """

    vertices: FloatArray
    faces: IntArray
    rgba: Rgba | None


def coarsen(
    vertices: FloatArray, faces: IntArray, grid: float = GRID
) -> tuple[FloatArray, IntArray]:
    """Merge vertices that share a cell of a grid [m] and drop triangles that collapse."""
    cells = np.round(vertices / grid).astype(np.int64)
    cells -= cells.min(axis=0, initial=0)
    numbers = np.ravel_multi_index((*cells.T,), (*(cells.max(axis=0, initial=0) + 1),))
    inverse = np.unique(numbers, return_inverse=True)[1]
    counts = np.bincount(inverse)[:, None]
    merged = np.stack([np.bincount(inverse, vertices[:, i]) for i in range(3)], axis=1) / counts
    faces = inverse[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    used, faces = np.unique(faces, return_inverse=True)
    return merged[used], faces.reshape(-1, 3)
