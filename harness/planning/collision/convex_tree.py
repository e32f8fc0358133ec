"""Trees of convex sets, with which the compiled check measures exact distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.robot.mesh_file import hull_of

POINTS, POLYTOPE, CYLINDER, HALF_SPACE = range(4)
"""Kinds of convex sets: a few points, corners of a hull with its edges, solids with a formula."""

FEW_POINTS = 32
"""Number of points up to which comparing all of them finds the farthest one the fastest."""


@dataclass(frozen=True, eq=False)
class ConvexTree:
    """A tree of nodes in preorder; a leaf is exact, and a node contains the nodes below it.

    A node is a ball and, where it has one, a convex set inside that ball. Boxes, hulls and other
    convex solids are a single node. The tree of an exact mesh ends with its triangles.

    Attributes:
        spheres: Centre and radius of each node's ball in the frame of the shape [m], shape (N, 4).
        nodes: The index after the subtree of each node, and its convex set or -1, shape (N, 2).
        convexes: The range of each set's points, and its kind, shape (C, 3).
        sizes: The radius by which each set is rounded; of a cylinder also its radius and half its
            length [m], shape (C, 3).
        points: The points of all sets [m], shape (P, 3); of a cylinder its centre, of a half space
            a point of its surface, each with a second point 1 m along the axis or the normal.
        edges_at: Where the neighbours of each point begin, shape (P + 1,).
        edges: The points that an edge of their polytope joins.
    """

    spheres: FloatArray
    nodes: IntArray
    convexes: IntArray
    sizes: FloatArray
    points: FloatArray
    edges_at: IntArray
    edges: IntArray

    def placed(self, rotation: FloatArray, translation: FloatArray) -> ConvexTree:
        """The tree of the moved shape."""
        spheres = self.spheres.copy()
        spheres[:, :3] = self.spheres[:, :3] @ rotation.T + translation
        points = self.points @ rotation.T + translation
        same = self.edges_at, self.edges
        return ConvexTree(spheres, self.nodes, self.convexes, self.sizes, points, *same)

    def root_corners(self) -> FloatArray | None:
        """Corners of a polytope that contains everything, shape (N, 3); None without one."""
        convex = int(self.nodes[0, 1])
        if convex < 0 or self.convexes[convex, 2] not in (POINTS, POLYTOPE):
            return None
        first, last, _ = self.convexes[convex].tolist()
        return None if self.sizes[convex, 0] > 0 else self.points[first:last]


def concatenate(trees: Sequence[ConvexTree]) -> ConvexTree:
    """Several trees one after another, their indices shifted."""
    trees = [_NOTHING, *trees]

    def rows(name: str) -> Any:
        return np.concatenate([getattr(tree, name) for tree in trees])

    def starts(name: str, each: str) -> IntArray:
        """Where the items of a tree begin, for each of its items of another kind."""
        sizes = [len(getattr(tree, name)) for tree in trees]
        return np.repeat(np.cumsum([0, *sizes[:-1]]), [len(getattr(tree, each)) for tree in trees])

    nodes, convexes = rows("nodes"), rows("convexes")
    has_set = nodes[:, 1] >= 0
    nodes += np.column_stack([starts("nodes", "nodes"), starts("convexes", "nodes") * has_set])
    convexes[:, :2] += starts("points", "convexes")[:, None]
    edges_at = np.concatenate([tree.edges_at[:-1] for tree in trees])
    edges = rows("edges") + starts("points", "edges")
    return ConvexTree(
        rows("spheres"),
        nodes,
        convexes,
        rows("sizes"),
        rows("points"),
        np.append(edges_at + starts("edges", "points"), len(edges)),
        edges,
    )


_NOTHING = ConvexTree(
    np.empty((0, 4)),
    np.empty((0, 2), dtype=np.int64),
    np.empty((0, 3), dtype=np.int64),
    np.empty((0, 3)),
    np.empty((0, 3)),
    np.zeros(1, dtype=np.int64),
    np.empty(0, dtype=np.int64),
)


def leaf(points: FloatArray, faces: IntArray | None = None, rounding: float = 0.0) -> ConvexTree:
    """A single node: a few points, or a polytope with its triangles, shape (F, 3)."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - middle, axis=1).max()) + rounding
    kind, edges = (POINTS, None) if faces is None else (POLYTOPE, _neighbours(faces, len(points)))
    return single_node([*middle, radius], kind, (rounding, 0.0, 0.0), points, edges)


def single_node(
    sphere: Sequence[float],
    kind: int,
    sizes: Sequence[float],
    points: FloatArray,
    edges: tuple[IntArray, IntArray] | None = None,
) -> ConvexTree:
    """A single node."""
    edges = edges or (np.zeros(len(points) + 1, dtype=np.int64), np.zeros(0, dtype=np.int64))
    convexes = np.array([[0, len(points), kind]])
    node = np.array([[1, 0]])
    return ConvexTree(np.array([sphere]), node, convexes, np.array([sizes]), points, *edges)


def _neighbours(faces: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """The points that an edge of a triangle joins with each point."""
    pairs = np.unique(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=0)
    pairs = np.unique(np.vstack([pairs, pairs[:, ::-1]]), axis=0)
    return np.searchsorted(pairs[:, 0], np.arange(count + 1)), np.ascontiguousarray(pairs[:, 1])


def coal_hull(hull: Any) -> ConvexTree:
    """The node of a hull of Coal's."""
    points = np.array(hull.points(), dtype=float).reshape(-1, 3)
    if len(points) <= FEW_POINTS:
        return leaf(points)
    polygons = (hull.polygons(row) for row in range(hull.num_polygons))
    return _polytope(points, np.array([(face[0], face[1], face[2]) for face in polygons]))


def hull_of_points(points: FloatArray) -> ConvexTree:
    """A node that contains points, shape (N, 3)."""
    if len(points) <= FEW_POINTS:
        return leaf(points)
    try:
        return coal_hull(hull_of(points))
    except RuntimeError:  # flat
        return leaf(points)


def _polytope(points: FloatArray, faces: IntArray) -> ConvexTree:
    """A node with the corners of triangles that enclose it, shape (F, 3)."""
    used, corners = np.unique(faces, return_inverse=True)
    return leaf(points[used], corners.reshape(-1, 3))


def joined(trees: Sequence[ConvexTree]) -> ConvexTree:
    """One tree above several, which are halved where there are many.

    Its nodes are hulls too where the shapes below are polytopes: one hull is compared in less time
    than all of its parts, and mostly suffices.
    """
    if len(trees) == 1:
        return trees[0]
    if len(trees) > 2:
        roots = np.array([tree.spheres[0, :3] for tree in trees])
        halves = _halves(roots, np.arange(len(trees)))
        return joined([joined([trees[row] for row in half]) for half in halves])
    below = concatenate(trees)
    solid = [corners for tree in trees if (corners := tree.root_corners()) is not None]
    if len(solid) == len(trees):
        tree = concatenate([hull_of_points(np.concatenate(solid)), below])
        tree.nodes[0, 0] = len(tree.nodes)
        return tree
    top, nodes = np.array([[1 + len(below.nodes), -1]]), below.nodes + np.array([1, 0])
    spheres = np.vstack([_ball_around(*(tree.spheres[0] for tree in trees)), below.spheres])
    return replace(below, spheres=spheres, nodes=np.vstack([top, nodes]))


def surface_tree(vertices: FloatArray, faces: IntArray) -> ConvexTree:
    """The tree of a surface: hulls of ever fewer triangles, halved down to single ones."""
    middles = vertices[faces].mean(axis=1)
    nodes: list[ConvexTree] = []
    ends: list[int] = []

    def add(members: IntArray) -> None:
        place = len(nodes)
        nodes.append(hull_of_points(vertices[np.unique(faces[members])]))
        ends.append(0)
        if len(members) > 1:
            for half in _halves(middles, members):
                add(half)
        ends[place] = len(nodes)

    add(np.arange(len(faces)))
    tree = concatenate(nodes)
    tree.nodes[:, 0] = ends
    return tree


def _ball_around(first: FloatArray, second: FloatArray) -> FloatArray:
    """Centre and radius of a ball that contains two others, shape (4,)."""
    balls = np.array([first, second])
    centers, radii = balls[:, :3], balls[:, 3]
    if not np.isfinite(radii).all():
        return np.array([0.0, 0.0, 0.0, np.inf])
    low, high = (centers - radii[:, None]).min(axis=0), (centers + radii[:, None]).max(axis=0)
    middle = 0.5 * (low + high)
    return np.append(middle, (np.linalg.norm(centers - middle, axis=1) + radii).max())


def _halves(places: FloatArray, members: IntArray) -> tuple[IntArray, IntArray]:
    """Members in two halves along the axis on which their places differ most."""
    axis = int(np.argmax(np.ptp(places[members], axis=0)))
    order = members[np.argsort(places[members, axis], kind="stable")]
    return order[: len(order) // 2], order[len(order) // 2 :]
