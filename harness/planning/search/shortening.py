"""Shortens a path by straight lines that the same edge check accepts; seeded, no clock."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker

TRIES = 60  # Random shortcuts tried on a path
WORTH = 0.01
"""Share of a path that a random shortcut must save to be checked: most save next to nothing."""


def shorten(
    waypoints: FloatArray, checker: MotionChecker, resolution: float, seed: int
) -> FloatArray:
    """Cut corners of a free path: waypoints dropped first, then random points on it joined.

    What remains of an edge is not checked anew: whoever needs it free at other states verifies the
    whole path.

    Args:
        checker: The checker of the edges; margins are kept as they were on the path.
        seed: The seed of the random points; the same seed gives the same path.

    Returns:
        Waypoints, shape (M, dof), M <= N mostly; the ends are the same.
    """
    path = _without_redundant_waypoints(waypoints, checker, resolution)
    knots = path_knots(path)
    for places in np.sort(np.random.default_rng(seed).random((TRIES, 2))).tolist():
        shortcut = find_shortcut(path, knots, places, WORTH)
        if shortcut is None:
            continue
        before, a, b, after = shortcut
        if checker.edge_free(a, b, resolution):
            path = without_repetitions(np.vstack([path[:before], a, b, path[after:]]))
            knots = path_knots(path)
    return _without_redundant_waypoints(path, checker, resolution)


def _without_redundant_waypoints(
    path: FloatArray, checker: MotionChecker, resolution: float
) -> FloatArray:
    """From each kept waypoint, go straight to the farthest that a free edge reaches."""
    kept, index = [0], 0
    while index < len(path) - 1:
        target = len(path) - 1
        while target > index + 1 and not checker.edge_free(path[index], path[target], resolution):
            target -= 1
        kept.append(target)
        index = target
    return path[kept]


def find_shortcut(
    path: FloatArray, knots: Sequence[float], places: Sequence[float], worth: float
) -> tuple[int, FloatArray, FloatArray, int] | None:
    """A straight line between two points on the path that is worth checking.

    Returns:
        The number of waypoints before the first point, both points, and the first waypoint after
        the second; None where both are on one edge, or the line saves too little.
    """
    first, second = (share * knots[-1] for share in places)
    before, after = (min(bisect_right(knots, each), len(path) - 1) for each in (first, second))
    if before == after:
        return None
    a, b = (_point(path, knots, *each) for each in ((first, before), (second, after)))
    if second - first - math.dist(a, b) < worth * knots[-1]:
        return None
    return before, a, b, after


def path_knots(path: FloatArray) -> list[float]:
    """The length of a path up to each waypoint."""
    return [0.0, *np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)).tolist()]


def _point(path: FloatArray, knots: Sequence[float], length: float, after: int) -> FloatArray:
    """The point after a length of the path, on the edge that ends at the waypoint `after`."""
    before = after - 1
    share = (length - knots[before]) / max(knots[after] - knots[before], 1e-12)
    return path[before] + (path[after] - path[before]) * share


def without_repetitions(path: FloatArray) -> FloatArray:
    """The waypoints that are apart from the one before."""
    apart = np.linalg.norm(np.diff(path, axis=0), axis=1) > 1e-9
    return path[np.append(True, apart)]
