"""Shortens a path by straight lines that the same edge check accepts; seeded, no clock."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker

TRIES = 60
"""Random shortcuts tried on a path."""

WORTH = 0.01
"""Share of a path that a random shortcut must save to be checked: most save next to nothing."""


def shorten(
    waypoints: FloatArray, checker: MotionChecker, resolution: float, seed: int
) -> FloatArray:
    """Cut corners of a free path: waypoints dropped first, then random points on it joined.

    Args:
        waypoints: The waypoints, free along the edges, shape (N, dof).
        checker: The checker of the edges; margins are kept as they were on the path.
        resolution: The resolution of the edge checks [rad].
        seed: The seed of the random points; the same seed gives the same path.

    Returns:
        Waypoints, shape (M, dof), M <= N mostly; the ends are the same.
    """
    path = _without_redundant_waypoints(list(waypoints), checker, resolution)
    rng = np.random.default_rng(seed)
    for _ in range(TRIES):
        if len(path) < 3:
            break
        path = _shortcut(path, np.sort(rng.random(2)), checker, resolution)
    return np.array(_without_redundant_waypoints(path, checker, resolution))


def _without_redundant_waypoints(
    path: list[FloatArray], checker: MotionChecker, resolution: float
) -> list[FloatArray]:
    """From each kept waypoint, go straight to the farthest that a free edge reaches."""
    kept, index = [path[0]], 0
    while index < len(path) - 1:
        target = len(path) - 1
        while target > index + 1 and not checker.edge_free(path[index], path[target], resolution):
            target -= 1
        kept.append(path[target])
        index = target
    return kept


def _shortcut(
    path: list[FloatArray], places: FloatArray, checker: MotionChecker, resolution: float
) -> list[FloatArray]:
    """Join two points on the path, given as shares of its length, if the line is free."""
    points = np.array(path)
    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    first, second = places * knots[-1]
    before, after = (
        min(int(np.searchsorted(knots, place, side="right")) - 1, len(path) - 2)
        for place in (first, second)
    )
    if before == after:
        return path
    a, b = (
        points[index]
        + (points[index + 1] - points[index]) * ((place - knots[index]) / _length(knots, index))
        for place, index in ((first, before), (second, after))
    )
    if second - first - float(np.linalg.norm(b - a)) < WORTH * knots[-1]:
        return path
    edges = ((a, b), (points[before], a), (b, points[after + 1]))  # parts are checked at new states
    if not all(checker.edge_free(*edge, resolution) for edge in edges):
        return path
    joined = [*path[: before + 1], a, b, *path[after + 1 :]]
    return [
        point
        for index, point in enumerate(joined)
        if index == 0 or np.linalg.norm(point - joined[index - 1]) > 1e-9
    ]


def _length(knots: FloatArray, index: int) -> float:
    return max(float(knots[index + 1] - knots[index]), 1e-12)
