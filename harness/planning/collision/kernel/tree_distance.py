"""Whether two trees of convex sets keep a distance over an interval."""

# Plain loops over arrays, no objects, no exceptions: numba compiles the functions below.
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

import math

import numpy as np

from harness.planning.collision.kernel.compiling import inlined
from harness.planning.collision.kernel.convex_distance import distance_bounds
from harness.planning.collision.kernel.motion_bound import motion_along

FREE, CLEAR_STATE, UNDECIDED, BLOCKED = range(4)
"""Answers about a pair over an interval: free throughout, free at the middle state, undecided and
blocked there."""

GIVE_UP = 0.7
"""Size of two nodes, relative to an interval's motion bound, below which they are not refined: a
shorter interval costs less. Nodes that are apart are not refined for the sake of the motion either.
"""


@inlined
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


@inlined
def compare_trees(
    tree, other, first, second, T, free, blocked, moves, motion, axis, stack, scratch
):
    """Whether two trees keep a distance over an interval and at its middle state.

    Args:
        tree: The arrays of the first tree, as of `certify.tree_at`.
        other: The same of the second tree.
        first: The root of the first tree, which is placed at T in the frame of the other.
        second: The root of the second tree.
        free: The distance above which a state is free.
        blocked: The distance below which a state is blocked.
        moves: Whether the interval is more than its middle state.
        motion: The motion over the interval, as in `motion_along`.
        axis: The direction of the last separating plane of this pair.
    """
    stack[0, 0], stack[0, 1] = first, second
    waiting, answer = 1, FREE
    local = scratch[13]
    spheres, nodes, far_spheres, far_nodes = tree[0], tree[1], other[0], other[1]
    while waiting > 0:
        waiting -= 1
        i, j = stack[waiting, 0], stack[waiting, 1]
        u, v, w = spheres[i, 0], spheres[i, 1], spheres[i, 2]
        x = T[0] * u + T[1] * v + T[2] * w + T[9] - far_spheres[j, 0]
        y = T[3] * u + T[4] * v + T[5] * w + T[10] - far_spheres[j, 1]
        z = T[6] * u + T[7] * v + T[8] * w + T[11] - far_spheres[j, 2]
        gap = math.sqrt(x * x + y * y + z * z)
        size = spheres[i, 3] + far_spheres[j, 3]
        if gap - size > free:
            if not moves or gap - size - motion[12] > free:
                continue
            if gap - size - motion_along(motion, x / gap, y / gap, z / gap) > free:
                continue
        a, b = nodes[i, 1], far_nodes[j, 1]
        i_leaf, j_leaf = nodes[i, 0] == i + 1, far_nodes[j, 0] == j + 1
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
                tree, other, a, b, T, moves, motion, free, wall, direction, scratch
            )
            if later > free:
                continue
            if is_exact:
                moves = False
                if most < blocked:
                    return BLOCKED
                answer = max(answer, CLEAR_STATE if least > free else UNDECIDED)
                continue
            if moves and (least > free or size < GIVE_UP * motion[12]):
                moves, answer = False, max(answer, CLEAR_STATE)
            if not moves and least > free:
                continue
        if j_leaf or (not i_leaf and spheres[i, 3] >= far_spheres[j, 3]):
            child = i + 1
            while child < nodes[i, 0]:
                if waiting >= stack.shape[0]:
                    return UNDECIDED
                stack[waiting, 0], stack[waiting, 1] = child, j
                waiting += 1
                child = nodes[child, 0]
        else:
            child = j + 1
            while child < far_nodes[j, 0]:
                if waiting >= stack.shape[0]:
                    return UNDECIDED
                stack[waiting, 0], stack[waiting, 1] = i, child
                waiting += 1
                child = far_nodes[child, 0]
    return answer
