"""A mesh as voxels: which space it fills, and how far the space around it is from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from harness.core.types import BoolArray, FloatArray, IntArray

MOST_VOXELS = 1_000_000  # Largest number of voxels of a grid

MOST_POINTS = 10_000_000
"""Approximate largest number of points on the surface; each takes about 100 bytes meanwhile."""

FINEST = 0.0005  # Smallest edge of a voxel [m]
POINTS_PER_EDGE = 3  # Points on the surface for each edge of a voxel, so that none is missed
BORDER = 2  # Empty voxels around the mesh


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


def solid_grid(triangles: FloatArray, edge: float) -> SolidGrid:
    """Fill the space around a mesh.

    Args:
        triangles: Corners [m], shape (M, 3, 3).
        edge: The requested edge of a voxel [m]; larger where `MOST_VOXELS` or `MOST_POINTS` require
            it, the latter for triangles that fill a space without order.
    """
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    edge = _edge(high - low, _area(triangles), edge)
    origin = low - (BORDER + 0.5) * edge
    shape = np.ceil((high - origin) / edge).astype(np.int64) + BORDER
    points = surface_points(triangles, edge / POINTS_PER_EDGE)
    voxel = ((points - origin) / edge).astype(np.int64)
    first = np.full(shape, -1)
    first[tuple(voxel[::-1].T)] = np.arange(len(points))[::-1]  # the last assignment stays
    surface = first >= 0
    depth = np.asarray(ndimage.distance_transform_edt(_outside(surface))) * edge
    return SolidGrid(origin, edge, depth, points[first[surface]])


def _area(triangles: FloatArray) -> float:
    """The area of triangles [m^2]."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2


def _edge(size: FloatArray, area: float, edge: float) -> float:
    edge = max(edge, FINEST)
    while (
        np.prod(np.ceil(size / edge) + 2 * BORDER + 1) > MOST_VOXELS
        or area * (POINTS_PER_EDGE / edge) ** 2 > MOST_POINTS
    ):
        edge *= 1.05
    return edge


def _outside(surface: BoolArray) -> BoolArray:
    """Voxels that are connected with the grid's first corner and not on the surface."""
    labels, _ = ndimage.label(~surface)  # pyright: ignore[reportGeneralTypeIssues]
    return np.asarray(labels == labels[0, 0, 0])


def surface_points(triangles: FloatArray, spacing: float) -> FloatArray:
    """Points on triangles, the corners and others at most a spacing apart, shape (N, 3) [m].

    They are on lines parallel to a triangle's longest side, so thin triangles have few.
    """
    sides = np.roll(triangles, -1, axis=1) - triangles
    length = np.linalg.norm(sides, axis=2)
    order = (length.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(triangles[np.arange(len(triangles))[:, None], order], 1, 0)
    longest = length.max(axis=1)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    lines = _steps(area / np.maximum(longest, 1e-12), spacing)
    triangle, share = _shares(lines)
    start, end = (corner[triangle] + share[:, None] * (c - corner)[triangle] for corner in (a, b))
    line, share = _shares(_steps((1 - share) * longest[triangle], spacing))
    return start[line] + share[:, None] * (end - start)[line]


def _steps(length: FloatArray, spacing: float) -> IntArray:
    return np.maximum(np.ceil(length / spacing), 1).astype(np.int64)


def _shares(steps: IntArray) -> tuple[IntArray, FloatArray]:
    """For each row the shares 0, 1/steps, ... 1: the numbers of the rows, and the shares."""
    row = np.repeat(np.arange(len(steps)), steps + 1)
    first = np.cumsum(steps + 1) - (steps + 1)
    return row, (np.arange(len(row)) - first[row]) / steps[row]
