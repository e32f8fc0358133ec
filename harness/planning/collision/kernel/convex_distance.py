"""Bounds of the distance between two convex sets."""

# Plain loops over arrays, no objects, no exceptions: numba compiles the functions below.
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

import math

import numpy as np

from harness.planning.collision.kernel.compiling import inlined
from harness.planning.collision.kernel.convex_kinds import CYLINDER, HALF_SPACE, POINTS
from harness.planning.collision.kernel.motion_bound import motion_along
from harness.planning.collision.kernel.simplex import reduce_simplex

CONVERGED = 1e-7
"""Difference of the bounds of a distance at which it is known [m]."""

MOST_ITERATIONS = 48


@inlined
def support(tree, c, x, y, z):
    """The point of a convex set that is farthest along a direction, without its rounding."""
    _, _, convexes, sizes, points, edges_at, edges, hints = tree
    first, last, kind = convexes[c, 0], convexes[c, 1], convexes[c, 2]
    if kind == CYLINDER:
        u, v, w = points[first, 0], points[first, 1], points[first, 2]
        a, b, h = points[first + 1, 0] - u, points[first + 1, 1] - v, points[first + 1, 2] - w
        along = a * x + b * y + h * z
        half = sizes[c, 2] if along >= 0.0 else -sizes[c, 2]
        x, y, z = x - along * a, y - along * b, z - along * h
        across = math.sqrt(x * x + y * y + z * z)
        wide = sizes[c, 1] / across if across > 1e-14 else 0.0
        return u + half * a + wide * x, v + half * b + wide * y, w + half * h + wide * z
    if kind == POINTS:
        best = first
        most = points[best, 0] * x + points[best, 1] * y + points[best, 2] * z
        for i in range(first + 1, last):
            along = points[i, 0] * x + points[i, 1] * y + points[i, 2] * z
            if along > most:
                best, most = i, along
        return points[best, 0], points[best, 1], points[best, 2]
    best = hints[c]
    most = points[best, 0] * x + points[best, 1] * y + points[best, 2] * z
    rises = True
    while rises:
        rises = False
        for k in range(edges_at[best], edges_at[best + 1]):
            i = edges[k]
            along = points[i, 0] * x + points[i, 1] * y + points[i, 2] * z
            if along > most:
                best, most, rises = i, along, True
    hints[c] = best
    return points[best, 0], points[best, 1], points[best, 2]


@inlined
def distance_bounds(tree, other, a, b, T, moves, motion, free, blocked, axis, scratch):
    """Bounds of the distance between two convex sets, the first placed at T in the second's frame.

    The Gilbert-Johnson-Keerthi algorithm [1]. Each support point along an axis gives a separating
    plane and so a lower bound that does not depend on how well the search has converged; every
    point of the difference gives an upper bound. The search ends when the lower bound exceeds
    `free` and the motion along the axis, or `free` alone where the interval cannot be certified, or
    when the upper bound is below `blocked`. A negative upper bound is minus a depth by which the
    sets overlap at least.

    Args:
        moves: Whether the interval is to be certified.
        motion: The motion over the interval, as in `motion_along`.
        axis: The direction from the second set to the first to start with; the best one is kept.

    Returns:
        The lower bound less the motion along its axis, the lower bound, and the upper bound.

    References:
        [1] E. Gilbert, D. Johnson, S. Keerthi, "A Fast Procedure for Computing the Distance Between
            Complex Objects in Three-Dimensional Space", IEEE J-RA 4(2), 1988.
    """
    convexes, sizes, points = other[2], other[3], other[4]
    if convexes[b, 2] == HALF_SPACE:
        at = convexes[b, 0]
        x = points[at, 0] - points[at + 1, 0]
        y = points[at, 1] - points[at + 1, 1]
        z = points[at, 2] - points[at + 1, 2]
        u, v, w = support(
            tree,
            a,
            T[0] * x + T[3] * y + T[6] * z,
            T[1] * x + T[4] * y + T[7] * z,
            T[2] * x + T[5] * y + T[8] * z,
        )
        u, v, w = (
            T[0] * u + T[1] * v + T[2] * w + T[9] - points[at, 0],
            T[3] * u + T[4] * v + T[5] * w + T[10] - points[at, 1],
            T[6] * u + T[7] * v + T[8] * w + T[11] - points[at, 2],
        )
        exact = -(u * x + v * y + w * z) - tree[3][a, 0]
        return exact - (motion_along(motion, x, y, z) if moves else 0.0), exact, exact
    S, near, trial, spare = scratch[3:10], scratch[10], scratch[11], scratch[12]
    rounding = tree[3][a, 0] + sizes[b, 0]
    vx, vy, vz = axis[0], axis[1], axis[2]
    count = 0
    later, least, most = -np.inf, -np.inf, np.inf
    for _ in range(MOST_ITERATIONS):
        size = math.sqrt(vx * vx + vy * vy + vz * vz)
        x, y, z = support(
            tree,
            a,
            -(T[0] * vx + T[3] * vy + T[6] * vz),
            -(T[1] * vx + T[4] * vy + T[7] * vz),
            -(T[2] * vx + T[5] * vy + T[8] * vz),
        )
        wx = T[0] * x + T[1] * y + T[2] * z + T[9]
        wy = T[3] * x + T[4] * y + T[5] * z + T[10]
        wz = T[6] * x + T[7] * y + T[8] * z + T[11]
        x, y, z = support(other, b, vx, vy, vz)
        wx, wy, wz = wx - x, wy - y, wz - z
        vx, vy, vz = vx / size, vy / size, vz / size
        bound = vx * wx + vy * wy + vz * wz - rounding
        ahead = bound - (motion_along(motion, vx, vy, vz) if moves else 0.0)
        if bound > least:
            least = bound
            axis[0], axis[1], axis[2] = vx, vy, vz
        later = max(later, ahead)
        most = min(most, math.sqrt(wx * wx + wy * wy + wz * wz) - rounding)
        if later > free or most < blocked or most - least < CONVERGED:
            break
        if least > free and most - (bound - ahead) <= free:
            break
        S[count, 0], S[count, 1], S[count, 2] = wx, wy, wz
        count, inside = reduce_simplex(S, count + 1, near, trial, spare)
        if count == 4:
            most = -inside - rounding
            break
        vx, vy, vz = near[0], near[1], near[2]
        size = math.sqrt(vx * vx + vy * vy + vz * vz)
        most = min(most, size - rounding)
        if most < blocked or size < 1e-12:  # touching or overlapping: the origin is on the simplex
            break
    return later, least, most
