"""Covers shapes with trees of spheres that contain every point of the shape."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Plane, Shape, Sphere
from harness.core.types import FloatArray, IntArray
from harness.robot.mesh_file import convex_hull, read_triangles

OVERSHOOT = 0.006
"""How far the smallest spheres extend beyond the shape, if `MOST_SPHERES` permits [m]."""

MOST_SPHERES = 16_384
"""Largest number of spheres on one level of a tree; large shapes are covered more coarsely."""

_ROUNDING = 1e-7  # [m]


@dataclass(frozen=True, eq=False)
class Cover:
    """A tree of spheres about a shape, in preorder: children follow their parent.

    Every point of the shape is in a sphere without children (a leaf), and in all spheres above it.
    All shapes are solids, and meshes are their convex hulls; only exact meshes are surfaces.

    Attributes:
        centers: The centres in the frame of the shape or body [m], shape (N, 3).
        outer: The radii [m], shape (N,).
        inner: The radius of a ball about the centre that is inside the shape; where it is negative,
            minus the distance from the centre to some point of the shape [m], shape (N,).
        skip: The index after the last sphere of each subtree, shape (N,).
    """

    centers: FloatArray
    outer: FloatArray
    inner: FloatArray
    skip: IntArray

    def placed(self, rotation: FloatArray, translation: FloatArray) -> Cover:
        """The cover of the moved shape."""
        return Cover(self.centers @ rotation.T + translation, self.outer, self.inner, self.skip)


def cover_shapes(shapes: Sequence[Shape]) -> Cover:
    """Cover several shapes that move together, in their common frame; none may be a plane."""
    covers = [
        cover(shape.geometry).placed(shape.pose.rotation, shape.pose.translation)
        for shape in shapes
    ]
    if len(covers) == 1:
        return covers[0]
    centers = np.array([each.centers[0] for each in covers])
    outer = np.array([each.outer[0] for each in covers])
    middle = 0.5 * ((centers - outer[:, None]).min(axis=0) + (centers + outer[:, None]).max(axis=0))
    radius = float(np.max(np.linalg.norm(centers - middle, axis=1) + outer)) + _ROUNDING
    inner = float(
        np.max([np.max(c.inner - np.linalg.norm(c.centers - middle, axis=1)) for c in covers])
    )
    starts = np.cumsum([1] + [len(each.outer) for each in covers])
    return Cover(
        np.vstack([middle[None], *(each.centers for each in covers)]),
        np.concatenate([[radius], *(each.outer for each in covers)]),
        np.concatenate([[inner], *(each.inner for each in covers)]),
        np.concatenate(
            [[starts[-1]], *(c.skip + at for c, at in zip(covers, starts, strict=False))]
        ).astype(np.int64),
    )


@lru_cache(maxsize=256)
def cover(geometry: Geometry) -> Cover:
    """Cover a geometry with spheres, in its own frame.

    Raises:
        TypeError: The geometry is a plane, which is unbounded.
        RobotError: A mesh file cannot be read.
    """
    if isinstance(geometry, Plane):
        raise TypeError("a plane has no cover")
    if isinstance(geometry, Sphere):
        return Cover(
            np.zeros((1, 3)),
            np.array([geometry.radius + _ROUNDING]),
            np.array([geometry.radius]),
            np.ones(1, dtype=np.int64),
        )
    if isinstance(geometry, Mesh):
        return _cover_surface(geometry) if geometry.collision == "exact" else _cover_hull(geometry)
    if isinstance(geometry, Capsule):
        return _cover_capsule(geometry)
    if isinstance(geometry, Box):
        halves = 0.5 * np.array(geometry.size)
    else:
        halves = np.array([geometry.radius, geometry.radius, 0.5 * geometry.length])

    def exact(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        distances = signed_distance(geometry, points)
        return distances, distances

    return _cover_solid(exact, np.zeros(3), halves)


def signed_distance(geometry: Geometry, points: FloatArray) -> FloatArray:
    """Distance from points (N, 3) to a solid [m], negative inside, shape (N,)."""
    size = np.abs(points)
    radial = np.hypot(points[:, 0], points[:, 1])
    match geometry:
        case Box(size=full):
            beyond = size - 0.5 * np.array(full)
        case Cylinder(radius=radius, length=length):
            beyond = np.column_stack([radial - radius, size[:, 2] - 0.5 * length])
        case Capsule(radius=radius, length=length):
            return np.hypot(radial, np.maximum(size[:, 2] - 0.5 * length, 0.0)) - radius
        case Sphere(radius=radius):
            return np.linalg.norm(points, axis=1) - radius
        case Plane():
            return points[:, 2]
        case Mesh():
            raise ValueError("a mesh has no closed-form distance")
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return outside + np.minimum(beyond.max(axis=1), 0.0)


def _cover_capsule(geometry: Capsule) -> Cover:
    """The two end balls and, between them, balls wide enough to overlap."""
    radius, length = geometry.radius, geometry.length
    widest = radius + OVERSHOOT
    count = max(1, int(np.ceil(0.5 * length / np.sqrt(widest**2 - radius**2))))
    half = 0.5 * length / count
    heights = np.concatenate(
        [[0.0, -0.5 * length], half * (2 * np.arange(count) - count + 1), [0.5 * length]]
    )
    outer = np.full(count + 3, np.hypot(radius, half))
    outer[0] = radius + 0.5 * length
    outer[[1, -1]] = radius
    skip = np.arange(1, count + 4)
    skip[0] = count + 3
    centers = np.zeros((count + 3, 3))
    centers[:, 2] = heights
    return Cover(centers, outer + _ROUNDING, np.full(count + 3, radius), skip)


Bounds = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Lower and upper bound of the signed distance from points to a solid; equal inside it."""


def _cover_hull(geometry: Mesh) -> Cover:
    """Cover a mesh's convex hull, given by the planes of its faces and its corners."""
    hull = convex_hull(geometry)
    points = np.array(hull.points(), dtype=float).reshape(-1, 3)
    faces = [hull.polygons(index) for index in range(hull.num_polygons)]
    corners = points[np.array([[face[0], face[1], face[2]] for face in faces], dtype=np.int64)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    normals = normals[sizes > 1e-14] / sizes[sizes > 1e-14, None]
    offsets = np.einsum("ij,ij->i", normals, corners[sizes > 1e-14, 0])
    inward = normals @ points.mean(axis=0) > offsets
    normals[inward], offsets[inward] = -normals[inward], -offsets[inward]

    def bounds(places: FloatArray) -> tuple[FloatArray, FloatArray]:
        beyond = (places @ normals.T - offsets).max(axis=1)
        outside = np.flatnonzero(beyond > 0)
        most = beyond.copy()
        for part in np.array_split(outside, 1 + len(outside) // 1024):
            away = places[part, None] - points[None]
            most[part] = np.sqrt(np.einsum("ijk,ijk->ij", away, away).min(axis=1))
        return beyond, most

    low, high = points.min(axis=0), points.max(axis=0)
    return _cover_solid(bounds, 0.5 * (low + high), 0.5 * (high - low))


def _cover_solid(bounds: Bounds, center: FloatArray, half: FloatArray) -> Cover:
    """Halve the bounding box until the spheres about its parts extend by at most `OVERSHOOT`."""
    centers, halves = center[None], half[None]
    levels: list[_Level] = []
    parents = np.full(1, -1, dtype=np.int64)
    while len(centers):
        radii = np.linalg.norm(halves, axis=1)
        least, most = bounds(centers)
        small = (radii + least <= OVERSHOOT) | (2 * len(centers) > MOST_SPHERES)
        levels.append(_Level(centers, radii + _ROUNDING, -most, parents))
        split = np.flatnonzero(~small)
        axis = np.argmax(halves[split], axis=1)
        step = np.zeros((len(split), 3))
        step[np.arange(len(split)), axis] = 0.5 * halves[split, axis]
        centers = np.stack([centers[split] - step, centers[split] + step], axis=1).reshape(-1, 3)
        halves = np.repeat(halves[split] - step, 2, axis=0)
        parents = np.repeat(split, 2)
        touching = bounds(centers)[0] < np.linalg.norm(halves, axis=1)
        centers, halves, parents = centers[touching], halves[touching], parents[touching]
    return _preorder(levels)


def _cover_surface(geometry: Mesh) -> Cover:
    """Subdivide large triangles, then halve the set of pieces until the spheres are small."""
    corners = _pieces(_corners(geometry), OVERSHOOT)  # (K, 3, 3)
    middles = corners.mean(axis=1)
    members = np.arange(len(corners))  # pieces, sorted by node
    starts = np.zeros(1, dtype=np.int64)
    parents = np.full(1, -1, dtype=np.int64)
    levels: list[_Level] = []
    while len(starts):
        counts = np.diff(np.append(starts, len(members)))
        node = np.repeat(np.arange(len(starts)), counts)
        points = corners[members]
        low = np.minimum.reduceat(points.min(axis=1), starts)
        high = np.maximum.reduceat(points.max(axis=1), starts)
        centers = 0.5 * (low + high)
        radii = _radii(points, centers, node, starts)
        near = _nearest(middles[members], centers, node, starts)
        surface = middles[members[near]]
        on_surface = _radii(points, surface, node, starts)
        small = on_surface <= 1.3 * OVERSHOOT
        centers = np.where(small[:, None], surface, centers)
        radii = np.where(small, on_surface, radii)
        leaf = small | (counts == 1) | (2 * len(starts) > MOST_SPHERES)
        away = np.linalg.norm(surface - centers, axis=1)
        levels.append(_Level(centers, radii + _ROUNDING, -away, parents))
        keep = ~leaf[node]
        members, node = members[keep], node[keep]
        axis = np.argmax(high - low, axis=1)
        along = middles[members, axis[node]]
        order = np.lexsort((along, node))
        members, node, along = members[order], node[order], along[order]
        split = np.flatnonzero(~leaf)
        first = np.cumsum(counts[split]) - counts[split]
        middle = 0.5 * (along[first] + along[first + counts[split] - 1])
        below = along <= np.repeat(middle, counts[split])
        share = np.add.reduceat(below, first) if len(split) else first
        share = np.where(share < counts[split], share, counts[split] // 2)
        starts = np.stack([first, first + share], axis=1).reshape(-1)
        parents = np.repeat(split, 2)
    return _preorder(levels)


@dataclass(frozen=True, eq=False)
class _Level:
    """The nodes at one depth of a tree; `parents` index the level above."""

    centers: FloatArray
    outer: FloatArray
    inner: FloatArray
    parents: IntArray


def _preorder(levels: Sequence[_Level]) -> Cover:
    """Convert the levels of a tree to preorder; the children of a node are adjacent."""
    sizes = [np.ones(len(level.outer), dtype=np.int64) for level in levels]
    for depth in range(len(levels) - 1, 0, -1):
        np.add.at(sizes[depth - 1], levels[depth].parents, sizes[depth])
    places = [np.zeros(1, dtype=np.int64)]
    for depth in range(1, len(levels)):
        parents, size = levels[depth].parents, sizes[depth]
        before = np.cumsum(size) - size
        is_first = np.concatenate([[True], parents[1:] != parents[:-1]])
        base = np.maximum.accumulate(np.where(is_first, before, 0))
        places.append(places[depth - 1][parents] + 1 + before - base)
    place = np.concatenate(places)
    order = np.argsort(place)
    skip = (place + np.concatenate(sizes))[order]
    return Cover(
        np.ascontiguousarray(np.vstack([level.centers for level in levels])[order]),
        np.concatenate([level.outer for level in levels])[order],
        np.concatenate([level.inner for level in levels])[order],
        skip,
    )


def _corners(geometry: Mesh) -> FloatArray:
    """Corners of a mesh's triangles [m], shape (K, 3, 3)."""
    mesh = read_triangles(geometry)
    return mesh.vertices[mesh.faces]


def _pieces(triangles: FloatArray, size: float) -> FloatArray:
    """Triangles halved at their longest edge until none is longer than twice a size."""
    done: list[FloatArray] = []
    count, most = 0, len(triangles) + 8 * MOST_SPHERES
    while len(triangles):
        edges = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)  # i to i + 1
        longest = np.argmax(edges, axis=1)
        small = edges[np.arange(len(edges)), longest] <= 2 * size
        if count + 2 * len(triangles) - int(small.sum()) > most:
            small[:] = True
        done.append(triangles[small])
        count += int(small.sum())
        rest, first = triangles[~small], longest[~small]
        rows = np.arange(len(rest))
        a, b, c = (rest[rows, (first + turn) % 3] for turn in range(3))
        middle = 0.5 * (a + b)
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
    return np.concatenate(done)


def _radii(points: FloatArray, centers: FloatArray, node: IntArray, starts: IntArray) -> FloatArray:
    """Distance from each node's centre to the farthest corner of its pieces."""
    away = np.linalg.norm(points - centers[node][:, None], axis=2).max(axis=1)
    return np.maximum.reduceat(away, starts)


def _nearest(
    middles: FloatArray, centers: FloatArray, node: IntArray, starts: IntArray
) -> IntArray:
    """Which piece of each node has its middle nearest to the node's centre."""
    away = np.linalg.norm(middles - centers[node], axis=1)
    order = np.lexsort((away, node))
    return order[starts]
