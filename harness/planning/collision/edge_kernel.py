"""The compiled first stage of edge checks: spheres certify parts of a motion (needs numba)."""

# The functions below are compiled: plain loops over arrays, no objects, no exceptions.

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

FREE, UNDECIDED, BLOCKED = 0, 1, 2

BOX, CYLINDER, CAPSULE, SPHERE, PLANE, MESH = range(6)

GIVE_UP = 0.7
"""Share of an interval's motion below which spheres are not refined: the interval is halved."""

_DEEPEST = 512  # stack size of sphere pairs when two trees are compared

_compiled: Any = numba.njit(cache=True, error_model="numpy", nogil=True)


@_compiled
def point_distance(kind, p, x, y, z):  # noqa: ANN001, ANN201
    """Distance from a point to a solid in its frame, negative inside; `p` holds its size."""
    if kind == SPHERE:
        return math.sqrt(x * x + y * y + z * z) - p[12]
    if kind == CAPSULE:
        h = abs(z) - p[13]
        if h < 0.0:
            h = 0.0
        return math.sqrt(x * x + y * y + h * h) - p[12]
    if kind == PLANE:
        return z
    if kind == CYLINDER:
        a = math.sqrt(x * x + y * y) - p[12]
        b = abs(z) - p[13]
        c = b
    else:
        a = abs(x) - p[12]
        b = abs(y) - p[13]
        c = abs(z) - p[14]
    inside = max(a, max(b, c))
    if inside <= 0.0:
        return inside
    a = max(a, 0.0)
    b = max(b, 0.0)
    c = max(c, 0.0) if kind == BOX else 0.0
    return math.sqrt(a * a + b * b + c * c)


@_compiled
def compose_transform(first, second, out):  # noqa: ANN001, ANN201
    """Product of two transforms, each rotation row by row, then translation."""
    for i in range(3):
        a, b, c = first[3 * i], first[3 * i + 1], first[3 * i + 2]
        for j in range(3):
            out[3 * i + j] = a * second[j] + b * second[3 + j] + c * second[6 + j]
        out[9 + i] = a * second[9] + b * second[10] + c * second[11] + first[9 + i]


@_compiled
def relative_transform(base, other, out):  # noqa: ANN001, ANN201
    """The transform of `other` relative to `base`."""
    x, y, z = other[9] - base[9], other[10] - base[10], other[11] - base[11]
    for i in range(3):
        a, b, c = base[i], base[3 + i], base[6 + i]
        for j in range(3):
            out[3 * i + j] = a * other[j] + b * other[3 + j] + c * other[6 + j]
        out[9 + i] = a * x + b * y + c * z


@_compiled
def joint_poses(values, parent, chain, out):  # noqa: ANN001, ANN201
    """Poses of the moving joints at their values."""
    fixed = np.empty(12)
    turned = np.empty(12)
    for m in range(parent.shape[0]):
        if parent[m] >= 0:
            compose_transform(out[parent[m]], chain[m], fixed)
        else:
            fixed[:] = chain[m, :12]
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
def shift_bound(widths, joints, first, last, chain, poses, x, y, z, radius):  # noqa: ANN001, ANN201
    """Motion bound of a ball's points when joints, tip first, move by at most their widths."""
    moved = 0.0
    for k in range(first, last):
        m = joints[k]
        w = widths[m]
        if chain[m, 15] > 0.5:
            moved += w
            continue
        pose = poses[m]
        a = pose[0] * chain[m, 12] + pose[1] * chain[m, 13] + pose[2] * chain[m, 14]
        b = pose[3] * chain[m, 12] + pose[4] * chain[m, 13] + pose[5] * chain[m, 14]
        c = pose[6] * chain[m, 12] + pose[7] * chain[m, 13] + pose[8] * chain[m, 14]
        u, v, t = x - pose[9], y - pose[10], z - pose[11]
        d, e, f = b * t - c * v, c * u - a * t, a * v - b * u
        moved += w * (math.sqrt(d * d + e * e + f * f) + radius + moved)
    return moved


@_compiled
def tree_to_solid(nodes, skip, start, end, T, kind, p, free, blocked, moved):  # noqa: ANN001, ANN201
    """Whether a tree of spheres, placed at T in a solid's frame, keeps a distance from the solid.

    `free` is the distance that certifies; below the distance `blocked` the bodies collide.
    """
    answer = FREE
    i = start
    while i < end:
        a, b, c = nodes[i, 0], nodes[i, 1], nodes[i, 2]
        x = T[0] * a + T[1] * b + T[2] * c + T[9]
        y = T[3] * a + T[4] * b + T[5] * c + T[10]
        z = T[6] * a + T[7] * b + T[8] * c + T[11]
        gap = point_distance(kind, p, x, y, z)
        outer = nodes[i, 3]
        if gap - outer > free + moved:
            i = skip[i]
            continue
        if gap - nodes[i, 4] < blocked:
            return BLOCKED
        if moved > 0.0:
            if gap - nodes[i, 4] <= free + moved or outer < GIVE_UP * moved or skip[i] == i + 1:
                return UNDECIDED
        elif skip[i] == i + 1:
            answer = UNDECIDED
        i += 1
    return answer


@_compiled
def tree_to_tree(nodes, skip, a0, b0, T, free, blocked, moved, stack):  # noqa: ANN001, ANN201
    """Whether two trees keep a distance; the first is placed at T in the second's frame."""
    stack[0, 0], stack[0, 1] = a0, b0
    waiting = 1
    while waiting > 0:
        waiting -= 1
        i, j = stack[waiting, 0], stack[waiting, 1]
        a, b, c = nodes[i, 0], nodes[i, 1], nodes[i, 2]
        x = T[0] * a + T[1] * b + T[2] * c + T[9] - nodes[j, 0]
        y = T[3] * a + T[4] * b + T[5] * c + T[10] - nodes[j, 1]
        z = T[6] * a + T[7] * b + T[8] * c + T[11] - nodes[j, 2]
        gap = math.sqrt(x * x + y * y + z * z)
        first, second = nodes[i, 3], nodes[j, 3]
        if gap - first - second > free + moved:
            continue
        least = gap - nodes[i, 4] - nodes[j, 4]
        if least < blocked:
            return BLOCKED
        if least <= free + moved or first + second < GIVE_UP * moved:
            return UNDECIDED
        if skip[i] == i + 1 and skip[j] == j + 1:
            return UNDECIDED
        if skip[j] == j + 1 or (first >= second and skip[i] != i + 1):
            child = i + 1
            while child < skip[i]:
                if waiting >= _DEEPEST:
                    return UNDECIDED
                stack[waiting, 0], stack[waiting, 1] = child, j
                waiting += 1
                child = skip[child]
        else:
            child = j + 1
            while child < skip[j]:
                if waiting >= _DEEPEST:
                    return UNDECIDED
                stack[waiting, 0], stack[waiting, 1] = i, child
                waiting += 1
                child = skip[child]
    return FREE


@_compiled
def certify(  # noqa: ANN201
    values,  # noqa: ANN001
    straight,  # noqa: ANN001
    nodes,  # noqa: ANN001
    skip,  # noqa: ANN001
    parent,  # noqa: ANN001
    chain,  # noqa: ANN001
    body_poses,  # noqa: ANN001
    bodies,  # noqa: ANN001
    part_data,  # noqa: ANN001
    parts,  # noqa: ANN001
    margins,  # noqa: ANN001
    checks,  # noqa: ANN001
    keys,  # noqa: ANN001
    joints,  # noqa: ANN001
    found,  # noqa: ANN001
):
    """Classify the states of a motion as free, blocked or undecided.

    The whole motion is certified first, then its halves: an interval is free for a check when the
    clearance of the spheres at its middle state exceeds the motion bound of the interval.

    Args:
        values: The positions of the moving joints, shape (N, M).
        straight: Whether the positions change at a constant rate.
        nodes: The spheres: centre, outer and inner radius, shape (K, 5).
        skip: The end of each sphere's subtree, shape (K,).
        parent: The moving joint before each moving joint, or -1, shape (M,).
        chain: Each joint's pose on its parent at 0 (12), axis (3), 1 if prismatic, shape (M, 16).
        body_poses: The bodies' poses on their joints or in the world, shape (B, 12).
        bodies: The joint or -1, first sphere and end of each body, shape (B, 3).
        part_data: The pose on the body (12) and the size (3) of each part, shape (P, 15).
        parts: The body, kind and first sphere of each part, shape (P, 3).
        margins: The distances above which a check is free and below which it is blocked, (C, 2).
        checks: The body, part and key of each check, shape (C, 3).
        keys: The two bodies of each key (-1: static), and the joints that move them relative to
            each other, as ranges of `joints`, shape (R, 6).
        joints: Moving joints, tip first.
        found: Output: the undecided states and their checks, shape (F, 2).

    Returns:
        A blocked state or -1; the number of undecided pairs, -1 when there are too many.
    """
    count, width = values.shape
    total = checks.shape[0]
    queue = np.empty((2 * count + 4, 4), dtype=np.int64)
    left = np.empty(64 * 1024, dtype=np.int32)
    for c in range(total):
        left[c] = c
    room = total
    poses = np.empty((width, 12))
    body_at = np.empty((bodies.shape[0], 12))
    part_at = np.empty((parts.shape[0], 12))
    body_stamp = np.full(bodies.shape[0], -1, dtype=np.int64)
    part_stamp = np.full(parts.shape[0], -1, dtype=np.int64)
    key_stamp = np.full(keys.shape[0], -1, dtype=np.int64)
    shifts = np.empty(keys.shape[0])
    widths = np.empty(width)
    T = np.empty(12)
    stack = np.empty((_DEEPEST, 2), dtype=np.int64)
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
            widest = 0.0
            if straight:
                widest = max(
                    abs(values[low, m] - values[middle, m]),
                    abs(values[high, m] - values[middle, m]),
                )
            else:
                for k in range(low, high + 1):
                    widest = max(widest, abs(values[k, m] - values[middle, m]))
            widths[m] = widest
        joint_poses(values[middle], parent, chain, poses)
        kept = room
        share = room + (end - begin) <= left.shape[0]
        failed = 0
        for place in range(begin, end):
            check = left[place]
            body, part, key = checks[check, 0], checks[check, 1], checks[check, 2]
            if body_stamp[body] != stamp:
                if bodies[body, 0] >= 0:
                    compose_transform(poses[bodies[body, 0]], body_poses[body], body_at[body])
                else:
                    body_at[body, :] = body_poses[body]
                body_stamp[body] = stamp
            owner = parts[part, 0]
            if part_stamp[part] != stamp:
                if body_stamp[owner] != stamp:
                    if bodies[owner, 0] >= 0:
                        compose_transform(
                            poses[bodies[owner, 0]], body_poses[owner], body_at[owner]
                        )
                    else:
                        body_at[owner, :] = body_poses[owner]
                    body_stamp[owner] = stamp
                compose_transform(body_at[owner], part_data[part], part_at[part])
                part_stamp[part] = stamp
            moved = 0.0
            if high > low:
                if key_stamp[key] != stamp:
                    shifts[key] = 0.0
                    for side in range(2):
                        b = keys[key, side]
                        if b >= 0 and keys[key, 3 + 2 * side] > keys[key, 2 + 2 * side]:
                            n = bodies[b, 1]
                            if body_stamp[b] != stamp:
                                compose_transform(poses[bodies[b, 0]], body_poses[b], body_at[b])
                                body_stamp[b] = stamp
                            B = body_at[b]
                            u, v, t = nodes[n, 0], nodes[n, 1], nodes[n, 2]
                            shifts[key] += shift_bound(
                                widths,
                                joints,
                                keys[key, 2 + 2 * side],
                                keys[key, 3 + 2 * side],
                                chain,
                                poses,
                                B[0] * u + B[1] * v + B[2] * t + B[9],
                                B[3] * u + B[4] * v + B[5] * t + B[10],
                                B[6] * u + B[7] * v + B[8] * t + B[11],
                                nodes[n, 3],
                            )
                    key_stamp[key] = stamp
                moved = shifts[key]
            kind = parts[part, 1]
            start, stop = bodies[body, 1], bodies[body, 2]
            free, blocked = margins[check, 0], margins[check, 1]
            P = part_at[part]
            if kind != MESH:  # the root sphere of the body first, in the part's frame
                B = body_at[body]
                u, v, t = nodes[start, 0], nodes[start, 1], nodes[start, 2]
                x = B[0] * u + B[1] * v + B[2] * t + B[9] - P[9]
                y = B[3] * u + B[4] * v + B[5] * t + B[10] - P[10]
                z = B[6] * u + B[7] * v + B[8] * t + B[11] - P[11]
                gap = point_distance(
                    kind,
                    part_data[part],
                    P[0] * x + P[3] * y + P[6] * z,
                    P[1] * x + P[4] * y + P[7] * z,
                    P[2] * x + P[5] * y + P[8] * z,
                )
                if gap - nodes[start, 3] > free + moved:
                    continue
            relative_transform(P, body_at[body], T)
            for turn in range(2):  # the interval, then its middle state alone
                if kind == MESH:
                    answer = tree_to_tree(
                        nodes, skip, start, parts[part, 2], T, free, blocked, moved, stack
                    )
                else:
                    answer = tree_to_solid(
                        nodes, skip, start, stop, T, kind, part_data[part], free, blocked, moved
                    )
                if answer == BLOCKED:
                    return middle, 0
                if answer == FREE:
                    break
                if moved > 0.0:
                    moved = 0.0
                    if share and turn == 0:
                        left[room + failed] = check
                        failed += 1
                    elif turn == 0:
                        failed += 1
                    continue
                if undecided == found.shape[0]:
                    return -1, -1
                found[undecided, 0] = middle
                found[undecided, 1] = check
                undecided += 1
                break
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
