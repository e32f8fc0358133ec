"""The tree of a mesh's surface: hulls of ever fewer triangles."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.planning.collision.convex_tree import (
    FEW_POINTS,
    POINTS,
    ConvexTree,
    hull_of_points,
)


def surface_tree(vertices: FloatArray, faces: IntArray) -> ConvexTree:
    """The tree of a surface: hulls of ever fewer triangles, halved down to single ones."""
    order, levels = _halved(vertices[faces].mean(axis=1))
    count = 2 * len(faces) - 1
    spheres, ends = np.empty((count, 4)), np.empty(count, dtype=np.int64)
    convexes = np.empty((count, 3), dtype=np.int64)
    points: list[FloatArray] = []
    hulls: list[tuple[int, ConvexTree]] = []
    used = 0
    for places, first, last in levels:
        ends[places] = places + 2 * (last - first) - 1
        of_node, corner = _corners_of_ranges(faces[order], first, last)
        starts = np.searchsorted(of_node, np.arange(len(places)))
        sizes = np.diff(np.append(starts, len(of_node)))
        corners = vertices[corner]
        is_few = sizes <= FEW_POINTS
        spheres[places] = _balls(corners, starts, sizes)
        for row in np.flatnonzero(~is_few).tolist():
            some = corners[starts[row] : starts[row] + sizes[row]]
            hulls.append((int(places[row]), hull_of_points(some)))
        points.append(corners[np.repeat(is_few, sizes)])
        begins = used + np.cumsum(sizes * is_few) - sizes * is_few
        convexes[places] = np.column_stack(
            [begins, begins + sizes, np.full(len(places), POINTS, dtype=np.int64)]
        )
        used += len(points[-1])
    edges_at, edges = [np.zeros(used, dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    edge_count = 0
    for place, hull in hulls:
        spheres[place], convexes[place] = hull.spheres[0], hull.convexes[0] + [used, used, 0]
        edges_at.append(hull.edges_at[:-1] + edge_count)
        edges.append(hull.edges + used)
        points.append(hull.points)
        used, edge_count = used + len(hull.points), edge_count + len(hull.edges)
    neighbours = np.concatenate(edges)
    return ConvexTree(
        spheres,
        np.column_stack([ends, np.arange(count)]),
        convexes,
        np.zeros((count, 3)),
        np.concatenate(points),
        np.append(np.concatenate(edges_at), len(neighbours)),
        neighbours,
    )


def _halved(places: FloatArray) -> tuple[IntArray, list[tuple[IntArray, IntArray, IntArray]]]:
    """Halve members along the axis on which their places differ most, down to single ones.

    Returns:
        The members in an order in which those of each node are adjacent; and for each level of the
        tree the preorder indices of its nodes, and their first members and those after the last.
    """
    order = np.arange(len(places))
    levels: list[tuple[IntArray, IntArray, IntArray]] = []
    at, first, last = np.array([0]), np.array([0]), np.array([len(places)])
    while len(at):
        levels.append((at, first, last))
        many = last - first > 1
        at, first, last = at[many], first[many], last[many]
        if not len(at):
            break
        sizes = last - first
        rows, node = _ranges(first, sizes)
        members = places[order[rows]]
        starts = np.cumsum(sizes) - sizes
        extents = np.maximum.reduceat(members, starts) - np.minimum.reduceat(members, starts)
        along = members[np.arange(len(rows)), extents.argmax(axis=1)[node]]
        order[rows] = order[rows[np.lexsort((along, node))]]
        middle = first + sizes // 2
        at = np.column_stack([at + 1, at + 2 * (middle - first)]).ravel()
        first, last = (np.column_stack(ends).ravel() for ends in ([first, middle], [middle, last]))
    return order, levels


def _ranges(first: IntArray, sizes: IntArray) -> tuple[IntArray, IntArray]:
    """The numbers in several ranges, and the range of each."""
    starts = np.cumsum(sizes) - sizes
    of_range = np.repeat(np.arange(len(sizes)), sizes)
    return np.arange(len(of_range)) + (first - starts)[of_range], of_range


def _corners_of_ranges(
    faces: IntArray, first: IntArray, last: IntArray
) -> tuple[IntArray, IntArray]:
    """The corners of the triangles in each of several ranges, once each, as range and corner."""
    rows, of_range = _ranges(first, last - first)
    corners = faces[rows]
    count = int(corners.max()) + 1
    return np.divmod(np.unique((of_range[:, None] * count + corners).ravel()), count)


def _balls(points: FloatArray, starts: IntArray, sizes: IntArray) -> FloatArray:
    """Centre and radius of a ball around each of several runs of points, shape (n, 4)."""
    middles = 0.5 * (np.minimum.reduceat(points, starts) + np.maximum.reduceat(points, starts))
    away = np.linalg.norm(points - np.repeat(middles, sizes, axis=0), axis=1)
    return np.column_stack([middles, np.maximum.reduceat(away, starts)])
