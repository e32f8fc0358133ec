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
from harness.robot.mesh_file import convex_hull, decomposition_of, hull_of, read_triangles

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

    def root_corners(self) -> FloatArray | None:
        """Corners of a polytope that contains everything, shape (N, 3); None without one."""
        convex = int(self.nodes[0, 1])
        if convex < 0 or self.convexes[convex, 2] not in (POINTS, POLYTOPE):
            return None
        first, last, _ = self.convexes[convex].tolist()
        return None if self.sizes[convex, 0] > 0 else self.points[first:last]


def shape_tree(shape: Shape) -> ConvexTree:
    """The tree of a shape in the frame that it is placed in.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    tree = geometry_tree(shape.geometry)
    return tree.placed(shape.pose.rotation, shape.pose.translation)


def shape_box(shape: Shape) -> FloatArray:
    """The lower and the upper corner of the box about a shape, shape (6,), in its outer frame.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    rotation, middle = shape.pose.rotation, shape.pose.translation
    match shape.geometry:
        case Box(size=size):
            reach = np.abs(rotation) @ size / 2
        case Sphere(radius=radius):
            reach = np.full(3, radius)
        case Capsule(radius=radius, length=length):
            reach = np.abs(rotation[:, 2]) * length / 2 + radius
        case Cylinder(radius=radius, length=length):
            across = np.sqrt(np.maximum(1.0 - rotation[:, 2] ** 2, 0.0))
            reach = np.abs(rotation[:, 2]) * length / 2 + across * radius
        case Plane():
            reach = np.full(3, np.inf)
        case Mesh():
            points = _points(shape.geometry) @ rotation.T + middle
            return np.concatenate([points.min(axis=0), points.max(axis=0)])
    return np.concatenate([middle - reach, middle + reach])


def _points(geometry: Mesh) -> FloatArray:
    """Points of a mesh whose convex hull contains all of it, shape (N, 3) [m]."""
    if geometry.collision == "exact":
        return read_triangles(geometry).vertices
    found, part = decomposition_of(geometry), geometry.part
    return found.hull if part is None else found.parts[part]


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
    return _coal_hull(convex_hull(geometry))


def _coal_hull(hull: Any) -> ConvexTree:
    """The node of a hull of Coal's."""
    points = np.array(hull.points(), dtype=float).reshape(-1, 3)
    if len(points) <= FEW_POINTS:
        return _leaf(points)
    polygons = (hull.polygons(row) for row in range(hull.num_polygons))
    return _polytope(points, np.array([(face[0], face[1], face[2]) for face in polygons]))


def _hull_of_solid(points: FloatArray) -> ConvexTree:
    """A node that contains the corners of solids, shape (N, 3)."""
    if len(points) <= FEW_POINTS:
        return _leaf(points)
    try:
        return _coal_hull(hull_of(points))
    except RuntimeError:  # flat
        return _leaf(points)


def _hull_of_points(points: FloatArray) -> ConvexTree:
    """A node that contains points, shape (N, 3)."""
    if len(points) <= FEW_POINTS:
        return _leaf(points)
    from scipy.spatial import ConvexHull, QhullError  # Coal's Qhull can crash on flat points

    try:
        return _polytope(points, ConvexHull(points).simplices.astype(np.int64))
    except QhullError:  # flat
        return _leaf(points)


def _polytope(points: FloatArray, faces: IntArray) -> ConvexTree:
    """A node with the corners of triangles that enclose it, shape (F, 3)."""
    used, corners = np.unique(faces, return_inverse=True)
    return _leaf(points[used], corners.reshape(-1, 3))


def _surface(vertices: FloatArray, faces: IntArray) -> ConvexTree:
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
            hulls.append((int(places[row]), _hull_of_points(some)))
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
        tree = concatenate([_hull_of_solid(np.concatenate(solid)), below])
        tree.nodes[0, 0] = len(tree.nodes)
        return tree
    top, nodes = np.array([[1 + len(below.nodes), -1]]), below.nodes + np.array([1, 0])
    spheres = np.vstack([_ball_around(*(tree.spheres[0] for tree in trees)), below.spheres])
    return replace(below, spheres=spheres, nodes=np.vstack([top, nodes]))


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
