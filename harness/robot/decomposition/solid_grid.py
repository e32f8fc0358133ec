"""A mesh as voxels: which space it fills, and how far the space around it is from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from harness.core.types import BoolArray, FloatArray

MOST_VOXELS = 1_000_000
"""Largest number of voxels of a grid."""

FINEST = 0.0005
"""Smallest edge of a voxel [m]."""

BORDER = 2
"""Empty voxels around the mesh."""


@dataclass(frozen=True, eq=False)
class SolidGrid:
    """The space around a mesh as voxels.

    A voxel is solid where the surface passes through it, or where no way leads to it from outside.
    So a closed mesh is filled, small cracks do no harm, and an open mesh is a sheet.

    Attributes:
        origin: The lower corner of the first voxel [m], shape (3,).
        edge: The edge of a voxel [m].
        depth: The distance of each voxel's centre from the nearest solid one [m], 0 in the solid,
            shape (X, Y, Z).
        surface: A point of the surface in every voxel that it passes through, shape (N, 3) [m].
    """

    origin: FloatArray
    edge: float
    depth: FloatArray
    surface: FloatArray

    def deeper_than(self, depth: float) -> tuple[FloatArray, FloatArray]:
        """Centres (N, 3) [m] and depths (N,) [m] of voxels farther from the solid than a depth."""
        index = np.nonzero(self.depth > depth)
        return self.origin + (np.column_stack(index) + 0.5) * self.edge, self.depth[index]

    def within(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same of voxels outside the solid between two corners [m]."""
        first = np.maximum(((low - self.origin) / self.edge).astype(np.int64), 0)
        last = ((high - self.origin) / self.edge).astype(np.int64) + 1
        block = self.depth[tuple(slice(a, b) for a, b in zip(first, last, strict=True))]
        index = np.nonzero(block)
        centers = self.origin + (np.column_stack(index) + first + 0.5) * self.edge
        return centers, block[index]

    @property
    def is_closed(self) -> bool:
        """Whether the mesh encloses voxels."""
        return int((self.depth == 0).sum()) > len(self.surface)


def solid_grid(triangles: FloatArray, edge: float) -> SolidGrid:
    """Fill the space around a mesh.

    Args:
        triangles: Corners [m], shape (M, 3, 3).
        edge: The requested edge of a voxel [m]; larger where `MOST_VOXELS` require it.
    """
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    edge = _edge(high - low, edge)
    origin = low - (BORDER + 0.5) * edge
    shape = np.ceil((high - origin) / edge).astype(np.int64) + BORDER
    points = surface_points(triangles, edge / 3)
    voxel = ((points - origin) / edge).astype(np.int64)
    surface = np.zeros(shape, dtype=bool)
    surface[tuple(voxel.T)] = True
    _, first = np.unique(np.ravel_multi_index(tuple(voxel.T), shape), return_index=True)
    solid = ~_outside(surface)
    return SolidGrid(
        origin, edge, np.asarray(ndimage.distance_transform_edt(~solid)) * edge, points[first]
    )


def _edge(size: FloatArray, edge: float) -> float:
    edge = max(edge, FINEST)
    while np.prod(np.ceil(size / edge) + 2 * BORDER + 1) > MOST_VOXELS:
        edge *= 1.05
    return edge


def _outside(surface: BoolArray) -> BoolArray:
    """Voxels that are connected with the grid's first corner and not on the surface."""
    labels, _ = ndimage.label(~surface)  # pyright: ignore[reportGeneralTypeIssues]
    return np.asarray(labels == labels[0, 0, 0])


def surface_points(triangles: FloatArray, spacing: float) -> FloatArray:
    """Points on triangles, the corners and others at most a spacing apart, shape (N, 3) [m]."""
    edges = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
    steps = np.maximum(np.ceil(edges.max(axis=1) / spacing), 1).astype(np.int64)
    points: list[FloatArray] = []
    for count in np.unique(steps):
        weights = _barycentric(int(count))
        points.append(np.einsum("wk,tkd->twd", weights, triangles[steps == count]).reshape(-1, 3))
    return np.concatenate(points)


def _barycentric(steps: int) -> FloatArray:
    """Weights of a triangular lattice with its corners, shape (W, 3)."""
    first, second = np.indices((steps + 1, steps + 1)).reshape(2, -1)
    is_inside = first + second <= steps
    first, second = first[is_inside], second[is_inside]
    return np.column_stack([first, second, steps - first - second]) / steps
