"""Shapes as trees of convex sets, with which the compiled check measures exact distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Plane, Shape, Sphere
from harness.core.types import FloatArray, IntArray
from harness.planning.collision.kernel.convex_kinds import CYLINDER, HALF_SPACE, POINTS, POLYTOPE
from harness.robot.mesh_file import convex_hull, read_triangles

FEW_POINTS = 32
"""Number of points up to which comparing all of them finds the farthest one the fastest."""


_CUBE = np.array(np.meshgrid(*([-0.5, 0.5],) * 3)).reshape(3, -1).T
"""The corners of the box with sides of 1 about the origin."""


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

    def box(self) -> FloatArray:
        """The lower and the upper corner of the box about all sets, shape (6,)."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        node = 0
        while node < len(self.nodes):
            end, convex = self.nodes[node].tolist()
            if convex < 0:
                node += 1
                continue
            node = end  # the set contains those below it
            first, last, kind = self.convexes[convex].tolist()
            rounding, radius, half = self.sizes[convex].tolist()
            points, reach = self.points[first:last], rounding
            if kind == HALF_SPACE:
                return np.repeat([-np.inf, np.inf], 3)
            if kind == CYLINDER:
                axis = points[1] - points[0]
                reach = np.abs(axis) * half + np.sqrt(np.maximum(1.0 - axis**2, 0.0)) * radius
                points = points[:1]
            low = np.minimum(low, points.min(axis=0) - reach)
            high = np.maximum(high, points.max(axis=0) + reach)
        return np.concatenate([low, high])


def shape_tree(shape: Shape) -> ConvexTree:
    """The tree of a shape in the frame that it is placed in.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    tree = geometry_tree(shape.geometry)
    return tree.placed(shape.pose.rotation, shape.pose.translation)


def concatenate(trees: Sequence[ConvexTree]) -> ConvexTree:
    """Several trees one after another, their indices shifted."""

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


@lru_cache(maxsize=1024)
def geometry_tree(geometry: Geometry) -> ConvexTree:
    """The tree of a geometry in its own frame.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    match geometry:
        case Box(size=size):
            reach = 0.5 * float(np.linalg.norm(size))
            return _node([0.0, 0.0, 0.0, reach], POINTS, (0.0, 0.0, 0.0), _CUBE * size)
        case Sphere(radius=radius):
            return _leaf(np.zeros((1, 3)), rounding=radius)
        case Capsule(radius=radius, length=length):
            return _leaf(_along_z(-0.5 * length, 0.5 * length), rounding=radius)
        case Cylinder(radius=radius, length=length):
            sizes, reach = (0.0, radius, 0.5 * length), float(np.hypot(radius, 0.5 * length))
            return _formula(CYLINDER, sizes, reach)
        case Plane():
            return _formula(HALF_SPACE, (0.0, 0.0, 0.0), np.inf)
        case Mesh(collision="exact"):
            mesh = read_triangles(geometry)
            return _surface(mesh.vertices, mesh.faces)
        case Mesh():
            return _hull(geometry)


def _along_z(*heights: float) -> FloatArray:
    return np.column_stack([np.zeros((len(heights), 2)), heights])


def _formula(kind: int, sizes: Sequence[float], reach: float) -> ConvexTree:
    """A solid about the origin whose farthest points follow from a formula."""
    return _node([0.0, 0.0, 0.0, reach], kind, sizes, _along_z(0.0, 1.0))


def _leaf(points: FloatArray, faces: IntArray | None = None, rounding: float = 0.0) -> ConvexTree:
    """A single node: a few points, or a polytope with its triangles, shape (F, 3)."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - middle, axis=1).max()) + rounding
    kind, edges = (POINTS, None) if faces is None else (POLYTOPE, _neighbours(faces, len(points)))
    return _node([*middle, radius], kind, (rounding, 0.0, 0.0), points, edges)


def _node(
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


def _hull(geometry: Mesh) -> ConvexTree:
    """The hull that Coal makes of a mesh's points."""
    hull = convex_hull(geometry)
    points = np.array(hull.points(), dtype=float).reshape(-1, 3)
    if len(points) <= FEW_POINTS:
        return _leaf(points)
    polygons = (hull.polygons(row) for row in range(hull.num_polygons))
    faces = np.array([(face[0], face[1], face[2]) for face in polygons], dtype=np.int64)
    used, faces = np.unique(faces, return_inverse=True)
    return _leaf(points[used], faces.reshape(-1, 3))


def _hull_of_points(points: FloatArray) -> ConvexTree:
    """A node that contains points, shape (N, 3)."""
    if len(points) <= FEW_POINTS:
        return _leaf(points)
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except QhullError:  # flat
        return _leaf(points)
    used, faces = np.unique(hull.simplices, return_inverse=True)
    return _leaf(points[used], faces.reshape(-1, 3))


def _surface(vertices: FloatArray, faces: IntArray) -> ConvexTree:
    """The tree of a surface: hulls of ever fewer triangles."""
    middles = vertices[faces].mean(axis=1)
    found: list[ConvexTree] = []
    ends: list[int] = []

    def descend(members: IntArray) -> None:
        place = len(found)
        found.append(_hull_of_points(vertices[np.unique(faces[members])]))
        ends.append(0)
        if len(members) > 1:
            for half in _halves(middles, members):
                descend(half)
        ends[place] = len(found)

    descend(np.arange(len(faces)))
    tree = concatenate(found)
    return replace(tree, nodes=np.column_stack([ends, tree.nodes[:, 1]]))


def joined(trees: Sequence[ConvexTree]) -> ConvexTree:
    """One tree above several, which are halved where there are many."""
    if len(trees) == 1:
        return trees[0]
    roots = np.array([tree.spheres[0] for tree in trees])
    if len(trees) > 2:
        halves = _halves(roots[:, :3], np.arange(len(trees)))
        return joined([joined([trees[row] for row in half]) for half in halves])
    centers, radii = roots[:, :3], roots[:, 3]
    if not np.isfinite(radii).all():
        root = np.array([0.0, 0.0, 0.0, np.inf])
    else:
        low, high = (centers - radii[:, None]).min(axis=0), (centers + radii[:, None]).max(axis=0)
        middle = 0.5 * (low + high)
        root = np.append(middle, (np.linalg.norm(centers - middle, axis=1) + radii).max())
    below = concatenate(trees)
    convexes = below.nodes[:, 1]
    top = np.array([[1 + len(below.nodes), -1]])
    nodes = np.vstack([top, np.column_stack([below.nodes[:, 0] + 1, convexes])])
    return replace(below, spheres=np.vstack([root, below.spheres]), nodes=nodes)


def _halves(places: FloatArray, members: IntArray) -> tuple[IntArray, IntArray]:
    """Members in two halves along the axis on which their places differ most."""
    axis = int(np.argmax(np.ptp(places[members], axis=0)))
    order = members[np.argsort(places[members, axis], kind="stable")]
    return order[: len(order) // 2], order[len(order) // 2 :]
