"""The compiled check of motions: conservative advancement with exact convex distances (numba)."""

# The functions below are compiled: plain loops over arrays, no objects, no exceptions. They are in
# one file because numba looks at no other one when it decides whether a compiled function is stale.
# ruff: noqa: ANN001, ANN201, ANN202, D417, SLF001

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
from numba.core import cgutils
from numba.extending import intrinsic

FREE, CLEAR_STATE, UNDECIDED, BLOCKED = range(4)
"""Answers about a pair over an interval: free throughout, free at the middle state, undecided and
blocked there."""

POINTS, POLYTOPE, CYLINDER, HALF_SPACE = range(4)
"""Kinds of convex sets: a few points, the corners of a hull with its edges, solids with a formula.
"""

GIVE_UP = 0.7
"""Size of two nodes, relative to an interval's motion bound, below which they are not refined."""

CONVERGED = 1e-7
"""Difference of the bounds of a distance at which it is known [m]."""

MOST_ITERATIONS = 48
_njit: Any = numba.njit
_intrinsic: Any = intrinsic
_options = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
_entry: Any = _njit(cache=True, **_options)
_compiled: Any = _njit(no_cpython_wrapper=True, **_options)
_inlined: Any = _njit(inline="always", **_options)


@_intrinsic
def borrowed(_, array):
    """The same array without its count of references: counting took ten times as long as the work.

    Whoever calls the compiled function keeps the array alive.
    """

    def generate(context, builder, _, arguments):
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), generate


@_compiled
def compose_transform(first, second, out):
    """Product of two transforms, each rotation row by row, then translation."""
    for i in range(3):
        a, b, c = first[3 * i], first[3 * i + 1], first[3 * i + 2]
        for j in range(3):
            out[3 * i + j] = a * second[j] + b * second[3 + j] + c * second[6 + j]
        out[9 + i] = a * second[9] + b * second[10] + c * second[11] + first[9 + i]


@_compiled
def relative_transform(base, other, out):
    """The transform of `other` relative to `base`."""
    x, y, z = other[9] - base[9], other[10] - base[10], other[11] - base[11]
    for i in range(3):
        a, b, c = base[i], base[3 + i], base[6 + i]
        for j in range(3):
            out[3 * i + j] = a * other[j] + b * other[3 + j] + c * other[6 + j]
        out[9 + i] = a * x + b * y + c * z


@_compiled
def joint_poses(values, parent, chain, out, scratch):
    """Poses of the moving joints at their values."""
    fixed, turned = scratch[1], scratch[2]
    for m in range(parent.shape[0]):
        if parent[m] >= 0:
            compose_transform(out[parent[m]], chain[m], fixed)
        else:
            for i in range(12):
                fixed[i] = chain[m, i]
        x, y, z = chain[m, 12], chain[m, 13], chain[m, 14]
        q = values[m]
        if chain[m, 15] > 0.5:  # prismatic
            for i in range(9):
                out[m, i] = fixed[i]
            for i in range(3):
                along = fixed[3 * i] * x + fixed[3 * i + 1] * y + fixed[3 * i + 2] * z
                out[m, 9 + i] = fixed[9 + i] + along * q
            continue
        c, s = math.cos(q), math.sin(q)
        v = 1.0 - c
        turned[0], turned[1], turned[2] = c + x * x * v, x * y * v - z * s, x * z * v + y * s
        turned[3], turned[4], turned[5] = x * y * v + z * s, c + y * y * v, y * z * v - x * s
        turned[6], turned[7], turned[8] = x * z * v - y * s, y * z * v + x * s, c + z * z * v
        turned[9], turned[10], turned[11] = 0.0, 0.0, 0.0
        compose_transform(fixed, turned, out[m])


@_compiled
def body_motion(rates, joints, first, last, chain, poses, x, y, z, radius, out):
    """How a ball moves when joints, listed tip first, move by their rates.

    Args:
        rates: How far each joint moves to either end of the interval, with its sign.
        out: Output: the first-order motion of the ball's centre (3), its rotation vector (3), its
            radius, a bound of the second-order motion of its points, and a bound of all motion.
    """
    turns = 0.0
    for k in range(first, last):
        if chain[joints[k], 15] <= 0.5:
            turns += abs(rates[joints[k]])
    moved = distal = second = 0.0
    vx = vy = vz = ox = oy = oz = 0.0
    for k in range(first, last):
        m = joints[k]
        rate, w = rates[m], abs(rates[m])
        a = poses[m, 0] * chain[m, 12] + poses[m, 1] * chain[m, 13] + poses[m, 2] * chain[m, 14]
        b = poses[m, 3] * chain[m, 12] + poses[m, 4] * chain[m, 13] + poses[m, 5] * chain[m, 14]
        c = poses[m, 6] * chain[m, 12] + poses[m, 7] * chain[m, 13] + poses[m, 8] * chain[m, 14]
        if chain[m, 15] > 0.5:
            vx, vy, vz = vx + rate * a, vy + rate * b, vz + rate * c
            moved += w
            distal += w
            second += w * turns
            continue
        u, v, t = x - poses[m, 9], y - poses[m, 10], z - poses[m, 11]
        d, e, f = b * t - c * v, c * u - a * t, a * v - b * u
        vx, vy, vz = vx + rate * d, vy + rate * e, vz + rate * f
        ox, oy, oz = ox + rate * a, oy + rate * b, oz + rate * c
        lever = math.sqrt(u * u + v * v + t * t) + radius + moved
        moved += w * (math.sqrt(d * d + e * e + f * f) + radius + moved)
        distal += w * lever
        turns -= w
        second += w * (2.0 * max(turns, 0.0) * lever + distal)
    out[0], out[1], out[2], out[3], out[4], out[5] = vx, vy, vz, ox, oy, oz
    out[6], out[7], out[8] = radius, 0.5 * second, moved


@_inlined
def motion_along(motion, x, y, z):
    """How much nearer two bodies come at most along a unit vector, over the interval.

    The points of a moving ball move along the vector by the motion of its centre, its rotation
    times the radius, and second-order terms; never by more than the bound of all motion.

    Args:
        motion: The motion of both bodies in the frame of the second: the motion of the centres (3),
            the rotations (3, 3), the radii (2), the second-order and the whole motion.
    """
    a, b, c = motion[3], motion[4], motion[5]
    d, e, f = y * c - z * b, z * a - x * c, x * b - y * a
    first = math.sqrt(d * d + e * e + f * f) * motion[9]
    a, b, c = motion[6], motion[7], motion[8]
    d, e, f = y * c - z * b, z * a - x * c, x * b - y * a
    first += math.sqrt(d * d + e * e + f * f) * motion[10]
    along = abs(motion[0] * x + motion[1] * y + motion[2] * z)
    return min(along + first + motion[11], motion[12])


@_compiled
def relative_motion(sides, key, straight, base, out):
    """The motion of two bodies as `motion_along` needs it, in the frame of the second."""
    for i in range(12):
        out[i] = 0.0
    out[12] = sides[0, 8] + sides[1, 8]
    if not straight:
        out[11] = out[12]
        return
    for side in range(2):
        if key[side] < 0:
            continue
        sign = 1.0 if side == 0 else -1.0
        for i in range(3):
            a, b, c = base[i], base[3 + i], base[6 + i]
            out[i] += sign * (a * sides[side, 0] + b * sides[side, 1] + c * sides[side, 2])
            out[3 + 3 * side + i] = a * sides[side, 3] + b * sides[side, 4] + c * sides[side, 5]
        out[9 + side] = sides[side, 6]
        out[11] += sides[side, 7]


@_inlined
def support(sets, c, x, y, z):
    """The point of a convex set that is farthest along a direction, without its rounding."""
    convexes, sizes, points, edges_at, edges, hints = sets
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


@_compiled
def nearest_on_segment(S, i, j, out):
    """The point of a segment nearest to the origin, as weights; returns its squared distance."""
    ex, ey, ez = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
    length = ex * ex + ey * ey + ez * ez
    t = 0.0
    if length > 0.0:
        t = -(S[i, 0] * ex + S[i, 1] * ey + S[i, 2] * ez) / length
        t = min(max(t, 0.0), 1.0)
    out[0], out[1], out[2] = S[i, 0] + t * ex, S[i, 1] + t * ey, S[i, 2] + t * ez
    out[3], out[4], out[5] = 1.0 - t, t, 0.0
    return out[0] * out[0] + out[1] * out[1] + out[2] * out[2]


@_compiled
def nearest_on_triangle(S, i, j, k, out, other):
    """The point of a triangle nearest to the origin, as weights; returns its squared distance."""
    ux, uy, uz = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
    vx, vy, vz = S[k, 0] - S[i, 0], S[k, 1] - S[i, 1], S[k, 2] - S[i, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    if square > 1e-24 * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        away = (S[i, 0] * nx + S[i, 1] * ny + S[i, 2] * nz) / square
        px, py, pz = away * nx - S[i, 0], away * ny - S[i, 1], away * nz - S[i, 2]
        b = (py * vz - pz * vy) * nx + (pz * vx - px * vz) * ny + (px * vy - py * vx) * nz
        c = (uy * pz - uz * py) * nx + (uz * px - ux * pz) * ny + (ux * py - uy * px) * nz
        b, c = b / square, c / square
        if b >= 0.0 and c >= 0.0 and b + c <= 1.0:
            out[0], out[1], out[2] = away * nx, away * ny, away * nz
            out[3], out[4], out[5] = 1.0 - b - c, b, c
            return away * away * square
    best = nearest_on_segment(S, i, j, out)
    square = nearest_on_segment(S, i, k, other)
    if square < best:
        best = square
        out[0], out[1], out[2] = other[0], other[1], other[2]
        out[3], out[4], out[5] = other[3], 0.0, other[4]
    square = nearest_on_segment(S, j, k, other)
    if square < best:
        best = square
        out[0], out[1], out[2] = other[0], other[1], other[2]
        out[3], out[4], out[5] = 0.0, other[3], other[4]
    return best


@_compiled
def reduce_simplex(S, count, near, trial, other):
    """Keep the corners of a simplex that span its point nearest to the origin.

    Args:
        S: The corners, and room for three more, shape (7, 3).
        count: The number of corners.
        near: Output: the nearest point, and the weights of the corners.
        trial: Working memory, as is `other`.

    Returns:
        The number of corners that are kept, first in S; of a tetrahedron about the origin all, and
        the origin's distance from its nearest face.
    """
    if count == 1:
        near[0], near[1], near[2] = S[0, 0], S[0, 1], S[0, 2]
        near[3] = 1.0
        return 1, -1.0
    first, second, third = 0, 1, 2
    inside = -1.0
    if count == 2:
        nearest_on_segment(S, count - 2, count - 1, near)
    elif count == 3:
        nearest_on_triangle(S, count - 3, count - 2, count - 1, near, other)
    else:
        best = np.inf
        inside = np.inf
        for i in range(4):
            j, k, o = (i + 1) % 4, (i + 2) % 4, (i + 3) % 4
            ux, uy, uz = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
            vx, vy, vz = S[k, 0] - S[i, 0], S[k, 1] - S[i, 1], S[k, 2] - S[i, 2]
            nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            size = math.sqrt(nx * nx + ny * ny + nz * nz)
            here = nx * S[i, 0] + ny * S[i, 1] + nz * S[i, 2]
            there = nx * (S[o, 0] - S[i, 0]) + ny * (S[o, 1] - S[i, 1]) + nz * (S[o, 2] - S[i, 2])
            depth = -here if there > 0.0 else here
            depth = depth / size if size > 0.0 and there != 0.0 else -1.0
            inside = min(inside, depth)
            if depth > 0.0:
                continue
            square = nearest_on_triangle(S, i, j, k, trial, other)
            if square < best:
                best = square
                for place in range(6):
                    near[place] = trial[place]
                first, second, third = i, j, k
        if inside > 0.0:
            return 4, inside
    remaining = 0
    for place in range(min(count, 3)):
        if near[3 + place] > 0.0:
            corner = first if place == 0 else (second if place == 1 else third)
            for i in range(3):
                S[4 + remaining, i] = S[corner, i]
            remaining += 1
    for place in range(remaining):
        for i in range(3):
            S[place, i] = S[4 + place, i]
    return remaining, inside


@_inlined
def distance_bounds(sets, a, b, T, moves, motion, free, blocked, axis, scratch):
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
    convexes, sizes, points = sets[0], sets[1], sets[2]
    if convexes[b, 2] == HALF_SPACE:
        at = convexes[b, 0]
        x = points[at, 0] - points[at + 1, 0]
        y = points[at, 1] - points[at + 1, 1]
        z = points[at, 2] - points[at + 1, 2]
        u, v, w = support(
            sets,
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
        exact = -(u * x + v * y + w * z) - sizes[a, 0]
        return exact - (motion_along(motion, x, y, z) if moves else 0.0), exact, exact
    S, near, trial, other = scratch[3:10], scratch[10], scratch[11], scratch[12]
    rounding = sizes[a, 0] + sizes[b, 0]
    vx, vy, vz = axis[0], axis[1], axis[2]
    count = 0
    later, least, most = -np.inf, -np.inf, np.inf
    for _ in range(MOST_ITERATIONS):
        size = math.sqrt(vx * vx + vy * vy + vz * vz)
        wx, wy, wz = T[9], T[10], T[11]
        for side in range(2):
            if side == 0:
                x = -(T[0] * vx + T[3] * vy + T[6] * vz)
                y = -(T[1] * vx + T[4] * vy + T[7] * vz)
                z = -(T[2] * vx + T[5] * vy + T[8] * vz)
            else:
                x, y, z = vx, vy, vz
            x, y, z = support(sets, a if side == 0 else b, x, y, z)
            if side == 0:
                wx += T[0] * x + T[1] * y + T[2] * z
                wy += T[3] * x + T[4] * y + T[5] * z
                wz += T[6] * x + T[7] * y + T[8] * z
            else:
                wx -= x
                wy -= y
                wz -= z
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
        count, inside = reduce_simplex(S, count + 1, near, trial, other)
        if count == 4:
            most = -inside - rounding
            break
        vx, vy, vz = near[0], near[1], near[2]
        size = math.sqrt(vx * vx + vy * vy + vz * vz)
        most = min(most, size - rounding)
        if most < blocked or size < 1e-12:  # touching or overlapping: the origin is on the simplex
            break
    return later, least, most


@_inlined
def box_gap(center, base, box, out):
    """The distance of a point from a box that is aligned with a frame, and the direction to it.

    Args:
        center: The point in the world.
        base: The frame's pose in the world.
        box: The lower and the upper corner of the box, shape (6,).
        out: Output: the unit vector from the box to the point in the world, where they are apart.
    """
    x, y, z = center[0] - base[9], center[1] - base[10], center[2] - base[11]
    u = base[0] * x + base[3] * y + base[6] * z
    v = base[1] * x + base[4] * y + base[7] * z
    w = base[2] * x + base[5] * y + base[8] * z
    u = u - min(max(u, box[0]), box[3])
    v = v - min(max(v, box[1]), box[4])
    w = w - min(max(w, box[2]), box[5])
    gap = math.sqrt(u * u + v * v + w * w)
    if gap > 0.0:
        u, v, w = u / gap, v / gap, w / gap
        for i in range(3):
            out[i] = base[3 * i] * u + base[3 * i + 1] * v + base[3 * i + 2] * w
    return gap


@_inlined
def compare_trees(
    spheres, nodes, sets, first, second, T, free, blocked, moves, motion, axis, stack, scratch
):
    """Whether two trees keep a distance over an interval and at its middle state.

    Args:
        first: The root of the tree that is placed at T in the frame of the other.
        second: The root of the other tree.
        free: The distance above which a state is free.
        blocked: The distance below which a state is blocked.
        moves: Whether the interval is more than its middle state.
        motion: The motion over the interval, as in `motion_along`.
        axis: The direction of the last separating plane of this pair.
    """
    stack[0, 0], stack[0, 1] = first, second
    waiting, answer = 1, FREE
    local = scratch[13]
    while waiting > 0:
        waiting -= 1
        i, j = stack[waiting, 0], stack[waiting, 1]
        u, v, w = spheres[i, 0], spheres[i, 1], spheres[i, 2]
        x = T[0] * u + T[1] * v + T[2] * w + T[9] - spheres[j, 0]
        y = T[3] * u + T[4] * v + T[5] * w + T[10] - spheres[j, 1]
        z = T[6] * u + T[7] * v + T[8] * w + T[11] - spheres[j, 2]
        gap = math.sqrt(x * x + y * y + z * z)
        size = spheres[i, 3] + spheres[j, 3]
        if gap - size > free:
            if not moves or gap - size - motion[12] > free:
                continue
            if gap - size - motion_along(motion, x / gap, y / gap, z / gap) > free:
                continue
        a, b = nodes[i, 1], nodes[j, 1]
        i_leaf, j_leaf = nodes[i, 0] == i + 1, nodes[j, 0] == j + 1
        is_exact = i_leaf and j_leaf
        if a >= 0 and b >= 0:
            direction = local
            if i == first and j == second:
                direction = axis
            else:
                local[0], local[1], local[2] = x, y, z
            if direction[0] == 0.0 and direction[1] == 0.0 and direction[2] == 0.0:
                direction[0], direction[1], direction[2] = x, y, z
                if gap == 0.0:
                    direction[0] = 1.0
            wall = blocked if is_exact else -np.inf
            later, least, most = distance_bounds(
                sets, a, b, T, moves, motion, free, wall, direction, scratch
            )
            if later > free:
                continue
            if is_exact:
                moves = False
                if most < blocked:
                    return BLOCKED
                answer = max(answer, CLEAR_STATE if least > free else UNDECIDED)
                continue
            if moves and size < GIVE_UP * motion[12]:
                moves, answer = False, max(answer, CLEAR_STATE)
                if least > free:
                    continue
        if j_leaf or (not i_leaf and spheres[i, 3] >= spheres[j, 3]):
            child = i + 1
            while child < nodes[i, 0]:
                if waiting >= stack.shape[0]:
                    return UNDECIDED
                stack[waiting, 0], stack[waiting, 1] = child, j
                waiting += 1
                child = nodes[child, 0]
        else:
            child = j + 1
            while child < nodes[j, 0]:
                if waiting >= stack.shape[0]:
                    return UNDECIDED
                stack[waiting, 0], stack[waiting, 1] = i, child
                waiting += 1
                child = nodes[child, 0]
    return answer


@_compiled
def move_to_front(order, check):
    """Compare a pair before all others from now on: it often blocks the next motion too."""
    place = 0
    while order[place] != check:
        place += 1
    while place > 0:
        order[place] = order[place - 1]
        place -= 1
    order[0] = check


@_entry
def certify(values, count, straight, robot, shapes, pairs, memory):
    """Classify the states of a motion as free, blocked or undecided.

    The last state is checked first, then the whole motion, then its halves: an interval is free for
    a pair when the distance at its middle state exceeds the motion bound of the interval.

    Args:
        values: The positions of the moving joints at all states, shape (count, M); of a straight
            motion at both its ends, shape (2, M), the first of which is not one of the states.
        count: The number of states.
        straight: Whether the motion is straight.
        robot: The moving joint before each moving joint, or -1, shape (M,); each joint's pose on
            its parent at 0 (12), axis (3), 1 if prismatic, shape (M, 16); the poses of the bodies
            on their joints or in the world, shape (B, 12); the joint or -1 and the root node of
            each body, shape (B, 2); the lower and upper corner of its bounding box, shape (B, 6).
        shapes: The arrays of a `ConvexTree` of all bodies, in its order.
        pairs: The distances above which a pair is free and below which it is blocked, shape (K, 2);
            its two bodies and its key, shape (K, 3); the two bodies of each key (-1: static) and
            the joints that move them relative to each other, as ranges of the last array, shape
            (R, 6); moving joints, tip first.
        memory: The working memory (`certificates.working_memory`) and, as its last array, the
            undecided states that are found.

    Returns:
        A blocked state or -1, and the number of undecided states.
    """
    values = borrowed(values)
    parent, chain = borrowed(robot[0]), borrowed(robot[1])
    body_poses, bodies, boxes = borrowed(robot[2]), borrowed(robot[3]), borrowed(robot[4])
    spheres, nodes, convexes = borrowed(shapes[0]), borrowed(shapes[1]), borrowed(shapes[2])
    sizes, points = borrowed(shapes[3]), borrowed(shapes[4])
    edges_at, edges = borrowed(shapes[5]), borrowed(shapes[6])
    margins, checks = borrowed(pairs[0]), borrowed(pairs[1])
    keys, joints = borrowed(pairs[2]), borrowed(pairs[3])
    here, rates, poses = borrowed(memory[0]), borrowed(memory[1]), borrowed(memory[2])
    body_at, middles, shifts = borrowed(memory[3]), borrowed(memory[4]), borrowed(memory[5])
    axes, scratch = borrowed(memory[6]), borrowed(memory[7])
    body_stamp, key_stamp = borrowed(memory[8]), borrowed(memory[9])
    hints, stack, queue = borrowed(memory[10]), borrowed(memory[11]), borrowed(memory[12])
    left, found = borrowed(memory[13]), borrowed(memory[14])
    sets = (convexes, sizes, points, edges_at, edges, hints)
    width = values.shape[1]
    total = checks.shape[0]
    for body in range(body_stamp.shape[0]):
        body_stamp[body] = -1
    for key in range(key_stamp.shape[0]):
        key_stamp[key] = -1
    room = total
    T, motion, way = scratch[0], scratch[14], scratch[15]
    undecided = 0
    queue[0, 0], queue[0, 1], queue[0, 2], queue[0, 3] = count - 1, count - 1, 0, total
    head, tail = 0, 1
    if count > 1:
        queue[1, 0], queue[1, 1], queue[1, 2], queue[1, 3] = 0, count - 2, 0, total
        tail = 2
    while head < tail:
        low, high, begin, end = queue[head, 0], queue[head, 1], queue[head, 2], queue[head, 3]
        stamp = head
        head += 1
        middle = (low + high) // 2
        for m in range(width):
            if straight:
                rate = (values[1, m] - values[0, m]) / count
                here[m] = values[0, m] + rate * (middle + 1)
                rates[m] = rate * max(high - middle, middle - low)
            else:
                here[m] = values[middle, m]
                widest = 0.0
                for k in range(low, high + 1):
                    widest = max(widest, abs(values[k, m] - here[m]))
                rates[m] = widest
        joint_poses(here, parent, chain, poses, scratch)
        kept = room
        share = room + (end - begin) <= left.shape[0]
        failed = 0
        is_open = False
        for place in range(begin, end):
            check = left[place]
            key = checks[check, 2]
            for side in range(2):
                body = checks[check, side]
                if body_stamp[body] != stamp:
                    if bodies[body, 0] >= 0:
                        compose_transform(poses[bodies[body, 0]], body_poses[body], body_at[body])
                    else:
                        for i in range(12):
                            body_at[body, i] = body_poses[body, i]
                    n = bodies[body, 1]
                    u, v, w = spheres[n, 0], spheres[n, 1], spheres[n, 2]
                    for i in range(3):
                        middles[body, i] = (
                            body_at[body, 3 * i] * u
                            + body_at[body, 3 * i + 1] * v
                            + body_at[body, 3 * i + 2] * w
                            + body_at[body, 9 + i]
                        )
                    body_stamp[body] = stamp
            moved = 0.0
            if high > low:
                if key_stamp[key] != stamp:
                    for side in range(2):
                        body = keys[key, side]
                        shifts[key, side, 8] = 0.0
                        if body >= 0:
                            body_motion(
                                rates,
                                joints,
                                keys[key, 2 + 2 * side],
                                keys[key, 3 + 2 * side],
                                chain,
                                poses,
                                middles[body, 0],
                                middles[body, 1],
                                middles[body, 2],
                                spheres[bodies[body, 1], 3],
                                shifts[key, side],
                            )
                    key_stamp[key] = stamp
                moved = shifts[key, 0, 8] + shifts[key, 1, 8]
            first, second = checks[check, 0], checks[check, 1]
            free, blocked = margins[check, 0], margins[check, 1]
            x = middles[first, 0] - middles[second, 0]
            y = middles[first, 1] - middles[second, 1]
            z = middles[first, 2] - middles[second, 2]
            least = spheres[bodies[first, 1], 3] + spheres[bodies[second, 1], 3] + free + moved
            if x * x + y * y + z * z > least * least:
                continue
            if high > low:
                relative_motion(shifts[key], keys[key], straight, body_at[second], motion)
            is_free = False
            for side in range(2):
                ball, body = (first, second) if side == 0 else (second, first)
                gap = box_gap(middles[ball], body_at[body], boxes[body], way)
                least = gap - spheres[bodies[ball, 1], 3] - free
                if least > moved:
                    is_free = True
                elif least > 0.0:
                    base = body_at[second]
                    least -= motion_along(
                        motion,
                        base[0] * way[0] + base[3] * way[1] + base[6] * way[2],
                        base[1] * way[0] + base[4] * way[1] + base[7] * way[2],
                        base[2] * way[0] + base[5] * way[1] + base[8] * way[2],
                    )
                    is_free = least > 0.0
                if is_free:
                    break
            if is_free:
                continue
            relative_transform(body_at[second], body_at[first], T)
            root, other_root = bodies[first, 1], bodies[second, 1]
            answer = compare_trees(
                spheres, nodes, sets, root, other_root, T, free, blocked, high > low, motion,
                axes[check], stack, scratch,
            )  # fmt: skip
            if answer == FREE:
                continue
            if answer == BLOCKED:
                move_to_front(left, check)
                return middle, 0
            if share:
                left[room + failed] = check
            failed += 1
            is_open |= answer == UNDECIDED
        if is_open:
            found[undecided] = middle
            undecided += 1
        if failed == 0 or high == low:
            continue
        first, last = begin, end
        if share:
            first, last = kept, kept + failed
            room += failed
        if middle > low:
            queue[tail, 0], queue[tail, 1] = low, middle - 1
            queue[tail, 2], queue[tail, 3] = first, last
            tail += 1
        queue[tail, 0], queue[tail, 1] = middle + 1, high
        queue[tail, 2], queue[tail, 3] = first, last
        tail += 1
    return -1, undecided
