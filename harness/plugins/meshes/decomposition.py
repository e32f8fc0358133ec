"""Approximate convex decomposition: cuts a mesh with planes until each part is nearly convex.

The parts are the convex hulls of the pieces of the surface between the cuts. The hull of a piece of
a closed surface is the hull of the piece of the solid, so the parts contain every point of the mesh
and, where it is closed, of its inside: no collision is missed. The largest distance of a point of a
part from the mesh is the excess, up to which a collision can be reported that is none. Cuts are
chosen greedily, as in Mamou and Ghorbel's HACD and V-HACD; afterwards, parts whose common hull is
good enough are merged.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.spatial import ConvexHull, QhullError
from trimesh.intersections import slice_faces_plane

from harness.core.types import BoolArray, FloatArray
from harness.plugins.meshes.solid_grid import SolidGrid, solid_grid
from harness.robot.convex_parts import Decomposition

HULL_TOLERANCE = 0.01  # The excess up to which the convex hull of the whole mesh is good enough [m]
TOLERANCE = 0.005  # The excess up to which a part is good enough, where the hull is not [m]
SMALL = 0.1  # A mesh whose longest side is shorter has proportionally smaller tolerances [m]
FINENESS = 1 / 5  # Edge of a voxel as a share of the tolerance

DIAGONAL = np.sqrt(3.0)
"""Distances between voxels, in edges, are off by at most as much from those between points."""

MOST_PARTS = 24  # Largest number of parts of a mesh
MOST_PIECES = 32  # Largest number of pieces before they are merged
THINNEST = 0.001  # Thickness of parts that are thinner, such as the walls of an open mesh [m]

POSITIONS = np.linspace(0.1, 0.9, 9)
"""Where a piece is cut along each normal, as shares of its extent."""

SAME_VOLUME = 1e-6  # Share of the hull's volume by which that of a convex mesh may differ
CORNER_TOLERANCE = 1e-4  # Height above the faces of a hull up to which its corners are left out [m]

NEARLY = 0.3
"""Height as a share of the largest from which a corner is kept at once with the highest."""

NO_TRIANGLES = np.zeros((0, 3, 3))

_H = np.sqrt(0.5)
NORMALS = np.array(
    [
        *np.eye(3),
        *[(_H, _H, 0), (_H, -_H, 0), (_H, 0, _H), (_H, 0, -_H), (0, _H, _H), (0, _H, -_H)],
    ]
)
"""Normals of the cuts: the axes, and half way between two of them; and those of large faces."""

SAME_NORMAL = 0.99  # Cosine of the angle below which two normals differ
MOST_FACES = 6  # Largest number of normals of faces of a piece along which it is cut


def _spread_directions(count: int) -> FloatArray:
    """Unit vectors spread over the sphere on a spiral, shape (count, 3)."""
    height = 1 - (2 * np.arange(count) + 1) / count
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    radius = np.sqrt(1 - height**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])


FEW_DIRECTIONS, MANY_DIRECTIONS = (
    np.concatenate([NORMALS, -NORMALS, _spread_directions(count)]) for count in (32, 160)
)
"""Directions whose farthest points stand for a hull where cuts are compared, as with samples."""

MOST_EMPTY = 20_000
"""Largest number of points that stand for the surface of a mesh, and for the space around it."""

FEW_SAMPLES, MANY_SAMPLES = 200, 2_000
"""Numbers of points with which cuts are compared, first all and then the best."""

GOOD_CUTS = 10  # Number of cuts that are compared with many points

PEEL = 0.5
"""What a volume that is not cut into convex parts yet costs, next to that of its empty space."""


def decompose(triangles: FloatArray, *, is_hull: bool = False) -> Decomposition:
    """Cut a mesh into convex parts; one part where its hull is within `HULL_TOLERANCE`.

    Args:
        triangles: Corners [m], shape (M, 3, 3); they need not be connected or closed.
        is_hull: Whether the hull is the only part in any case, so that nothing is cut.
    """
    hull = ConvexHull(triangles.reshape(-1, 3))
    longest = float(np.ptp(hull.points, axis=0).max())
    share = min(longest / SMALL, 1.0)
    corners = _few_corners(hull.points[hull.vertices], CORNER_TOLERANCE * share)
    if abs(_volume(triangles) - hull.volume) < SAME_VOLUME * hull.volume:
        return Decomposition(corners, (corners,), 0.0, 0.0)
    tolerance = TOLERANCE * share
    grid = solid_grid(triangles, tolerance * FINENESS)
    search = _Search(grid, max(tolerance - DIAGONAL * grid.edge, 0.5 * tolerance, grid.edge))
    hull_excess = _excess(grid, corners)
    if is_hull or hull_excess <= HULL_TOLERANCE * share:
        return Decomposition(corners, (corners,), hull_excess, hull_excess)
    pieces = _merged(search, _cut(search, search.piece(triangles)))
    parts = tuple(
        _thickened(_few_corners(_corners(piece.triangles.reshape(-1, 3)), CORNER_TOLERANCE * share))
        for piece in pieces
    )
    excess = max(_excess(grid, part) for part in parts)
    return Decomposition(corners, parts, excess, hull_excess)


def _volume(triangles: FloatArray) -> float:
    """The volume that consistently oriented triangles enclose [m^3]."""
    a, b, c = np.moveaxis(triangles - triangles.mean(axis=(0, 1)), 1, 0)
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6


def _excess(grid: SolidGrid, points: FloatArray) -> float:
    """The largest distance of a point in the hull of points from the mesh [m], rounded up."""
    hull = _hull(points)
    if hull is None:
        return 0.0
    low, high = hull.min_bound, hull.max_bound
    centers, depth = grid.within(low, high)
    excess = 0.0
    for most in (MANY_SAMPLES, len(depth)):  # after some of the voxels, only deeper ones matter
        deeper = depth > excess
        some, reached = _thinned(centers[deeper], most), _thinned(depth[deeper], most)
        excess = float(reached[_inside(hull, some)].max(initial=excess))
    return excess + DIAGONAL * grid.edge


@dataclass(frozen=True, eq=False)
class _Piece:
    """A piece of the surface.

    Attributes:
        triangles: Its triangles [m], shape (M, 3, 3).
        points: The farthest of its points in `MANY_DIRECTIONS` [m], shape (N, 3).
        excess: The largest distance of a point of the hull from the mesh [m].
        empty: Centres of voxels in the hull that are too far from the mesh, or some of them,
            shape (E, 3).
        volume: The volume of the hull [m^3].
    """

    triangles: FloatArray
    points: FloatArray
    excess: float
    empty: FloatArray
    volume: float


class _Search:
    """Measures pieces, and looks for the best cut of one."""

    def __init__(self, grid: SolidGrid, tolerance: float) -> None:
        self.edge = grid.edge
        self._surface = _thinned(grid.surface, MOST_EMPTY)
        empty, depth = grid.deeper_than(tolerance)
        self._empty, self._depth = _thinned(empty, MOST_EMPTY), _thinned(depth, MOST_EMPTY)

    def piece(self, triangles: FloatArray) -> _Piece:
        """A piece with its measures."""
        return self._measured(_extreme(_corners(triangles.reshape(-1, 3))), triangles)

    def union(self, first: _Piece, second: _Piece) -> _Piece:
        """Two pieces as one, without its triangles."""
        return self._measured(_extreme(np.concatenate([first.points, second.points])), NO_TRIANGLES)

    def _measured(self, points: FloatArray, triangles: FloatArray) -> _Piece:
        hull = _hull(points)
        if hull is None:
            return _Piece(triangles, points, 0.0, np.zeros((0, 3)), 0.0)
        inside = _inside(hull, self._empty)
        excess = float(self._depth[inside].max(initial=0.0))
        return _Piece(triangles, points, excess, self._empty[inside], float(hull.volume))

    def best_cut(self, piece: _Piece) -> tuple[FloatArray, float] | None:
        """Normal and offset of the cut that leaves the least empty space in convex hulls.

        All cuts are compared with few points, and the best of them again with many.
        """
        inside = self._surface[_inside(ConvexHull(piece.points), self._surface, 1e-6)]
        cuts = [
            (normal, offset)
            for normal in (*NORMALS, *_face_normals(piece.triangles))
            for offset in _offsets(piece.points @ normal, piece.empty @ normal, self.edge)
        ]
        for samples, directions, kept in (
            (FEW_SAMPLES, FEW_DIRECTIONS, GOOD_CUTS),
            (MANY_SAMPLES, MANY_DIRECTIONS, 1),
        ):
            points = np.concatenate([_thinned(inside, samples), piece.points])
            empty = _thinned(piece.empty, samples)
            costs = [_cost(points, empty, *cut, PEEL / piece.volume, directions) for cut in cuts]
            cuts = [cuts[number] for number in np.argsort(costs, kind="stable")[:kept]]
        return cuts[0] if cuts else None


def _cost(
    points: FloatArray,
    empty: FloatArray,
    normal: FloatArray,
    offset: float,
    peel: float,
    directions: FloatArray,
) -> float:
    """Empty space in the hulls on both sides of a cut, and the volume of hulls that have any."""
    heights, empty_heights = points @ normal - offset, empty @ normal - offset
    cost, diameter = 0.0, float(np.linalg.norm(np.ptp(points, axis=0)))
    for side in (1.0, -1.0):
        empty_half = empty[side * empty_heights > 0]
        hull = _hull(_extreme(points[side * heights > 0], directions)) if len(empty_half) else None
        inside = 0 if hull is None else int(_inside(hull, empty_half).sum())
        if hull is not None and inside:
            share = float(np.linalg.norm(np.ptp(hull.points, axis=0))) / diameter
            cost += share * inside / len(empty) + peel * float(hull.volume)
    return cost


def _face_normals(triangles: FloatArray) -> FloatArray:
    """Normals of the largest faces that are not among `NORMALS`, up to their sign, shape (N, 3)."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    normals = np.cross(b - a, c - a)
    area = np.linalg.norm(normals, axis=1)
    normals = np.round(normals / np.maximum(area, 1e-15)[:, None], 2) + 0.0
    found, row = np.unique(normals, axis=0, return_inverse=True)
    chosen = [*NORMALS]
    for number in np.argsort(-np.bincount(row.ravel(), area), kind="stable"):
        normal = found[number] / max(float(np.linalg.norm(found[number])), 1e-9)
        if np.abs(np.array(chosen) @ normal).max() < SAME_NORMAL:
            chosen.append(normal)
        if len(chosen) == len(NORMALS) + MOST_FACES:
            break
    return np.array(chosen[len(NORMALS) :]).reshape(-1, 3)


def _offsets(points: FloatArray, empty: FloatArray, edge: float) -> Iterator[float]:
    """Where to cut along a normal: at shares of the extent, and where empty space begins."""
    low, high = float(points.min()), float(points.max())
    for offset in (*(low + POSITIONS * (high - low)), empty.min() - edge, empty.max() + edge):
        if low + edge < offset < high - edge:
            yield float(offset)


def _cut(search: _Search, whole: _Piece) -> list[_Piece]:
    """Cut the piece with the largest excess, until all are good or there are `MOST_PIECES`."""
    done: list[_Piece] = []
    pieces = [whole]
    while pieces:
        worst = max(pieces, key=lambda piece: piece.excess)
        pieces.remove(worst)
        is_last = len(done) + len(pieces) + 2 > MOST_PIECES
        cut = None if is_last or not worst.excess else search.best_cut(worst)
        if cut is None:
            done.append(worst)
        else:
            pieces += [search.piece(side) for side in _split(worst.triangles, *cut)]
    return done


def _split(
    triangles: FloatArray, normal: FloatArray, offset: float
) -> tuple[FloatArray, FloatArray]:
    """The triangles below and above a plane; those that it crosses are cut."""
    corners, faces = triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    below, above = (
        points[rows]
        for points, rows, _ in (
            slice_faces_plane(corners, faces, side * normal, offset * normal) for side in (-1, 1)
        )
    )
    return below, above


def _merged(search: _Search, pieces: list[_Piece]) -> list[_Piece]:
    """Merge parts while their common hull is good enough, or there are too many."""
    known = dict(enumerate(pieces))
    unions: dict[tuple[int, int], tuple[float, float, _Piece]] = {}
    while len(known) > 1:
        for pair in combinations(known, 2):
            if pair not in unions:
                first, second = known[pair[0]], known[pair[1]]
                union = search.union(first, second)
                added = union.volume - first.volume - second.volume
                unions[pair] = union.excess, added, union
        best = min(unions, key=lambda pair: (*unions[pair][:2], pair))
        if unions[best][0] > 0 and len(known) <= MOST_PARTS:
            break
        triangles = np.concatenate([known[number].triangles for number in best])
        known[max(known) + 1] = replace(unions[best][2], triangles=triangles)
        for gone in best:
            del known[gone]
        unions = {pair: union for pair, union in unions.items() if not set(pair) & set(best)}
    return list(known.values())


def _extreme(points: FloatArray, directions: FloatArray = MANY_DIRECTIONS) -> FloatArray:
    """The farthest of some points in each of many directions."""
    if len(points) <= len(directions):
        return points
    return points[np.unique((points @ directions.T).argmax(axis=0))]


def _corners(points: FloatArray) -> FloatArray:
    """The corners of the convex hull of points; all of them where they are flat."""
    hull = _hull(points)
    return np.unique(points, axis=0) if hull is None else points[hull.vertices]


def _few_corners(corners: FloatArray, tolerance: float) -> FloatArray:
    """Corners of a convex hull without those that hardly stand out of it, which fillets have.

    Args:
        corners: Corners [m], shape (N, 3).
        tolerance: Largest height above the faces of the hull of the others [m].
    """
    hull, left = _hull(_extreme(corners, FEW_DIRECTIONS)), corners
    while hull is not None:
        normals, offsets = hull.equations[:, :3], hull.equations[:, 3]
        highest = np.array([left[(left @ normal).argmax()] for normal in normals])
        heights = np.einsum("ij,ij->i", highest, normals) + offsets
        if heights.max() <= tolerance:
            return hull.points[hull.vertices]
        added = np.unique(highest[heights > max(tolerance, NEARLY * heights.max())], axis=0)
        left = left[~_inside(hull, left, tolerance)]
        hull = _hull(np.concatenate([hull.points[hull.vertices], added]))
    return corners


def _thinned(points: FloatArray, most: int) -> FloatArray:
    """At most a given number of points, chosen at random; the same for arrays of equal length."""
    if len(points) <= most:
        return points
    # A fixed stride would leave out whole planes of a grid.
    return points[np.random.default_rng(0).permutation(len(points))[:most]]


def _thickened(points: FloatArray) -> FloatArray:
    """The points of a part that has at least the thickness `THINNEST`."""
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2][-1]
    height = (points - middle) @ normal
    lack = THINNEST - float(np.ptp(height))
    if lack <= 0:
        return points
    return np.concatenate([points + 0.5 * lack * normal, points - 0.5 * lack * normal])


def _hull(points: FloatArray) -> ConvexHull | None:
    """The convex hull of points, or None where they are flat."""
    if len(points) < 4:
        return None
    try:
        return ConvexHull(points)
    except QhullError:
        return None


def _inside(hull: ConvexHull, points: FloatArray, slack: float = 0.0) -> BoolArray:
    """Which points are in a hull, shape (N,)."""
    low, high = hull.min_bound - slack, hull.max_bound + slack
    left = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
    faces = hull.equations
    for start in range(0, len(faces), 16):
        some = faces[start : start + 16]
        heights = points[left] @ some[:, :3].T + some[:, 3]
        left = left[(heights <= slack).all(axis=1)]
    inside = np.zeros(len(points), dtype=bool)
    inside[left] = True
    return inside
