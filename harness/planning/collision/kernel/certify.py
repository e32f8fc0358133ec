"""Conservative advancement of a motion with exact convex distances."""

# Plain loops over arrays, no objects, no exceptions: numba compiles the functions below.
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

import numpy as np

from harness.planning.collision.kernel.compiling import (
    compiled,
    floats_1d,
    floats_2d,
    floats_3d,
    indices_1d,
    indices_2d,
    inlined,
    integers_1d,
    integers_2d,
)
from harness.planning.collision.kernel.motion_bound import (
    body_motion,
    compose_transform,
    joint_poses,
    motion_along,
    relative_motion,
    relative_transform,
)
from harness.planning.collision.kernel.results import FULL
from harness.planning.collision.kernel.tree_distance import (
    BLOCKED,
    CLEAR_STATE,
    FREE,
    UNDECIDED,
    box_gap,
    compare_trees,
)

CONTACT_STATES = 64
"""Number of states up to which a stretch is left undecided as a whole, where all pairs that are not
certified may be in contact: how deep they are is not measured here."""


@compiled
def move_to_front(order, check):
    """Compare a pair before all others from now on: it often blocks the next motion too."""
    place = 0
    while order[place] != check:
        place += 1
    while place > 0:
        order[place] = order[place - 1]
        place -= 1
    order[0] = check


@inlined
def segment_of(places, place):
    """The number of the segment of a polyline that contains a place."""
    low, high = 0, places.shape[0] - 2
    while low < high:
        middle = (low + high + 1) // 2
        if places[middle] <= place:
            low = middle
        else:
            high = middle - 1
    return low


@inlined
def tree_at(table, row):
    """The arrays of a `ConvexTree` in its order, and a point of each set to begin a search with."""
    return (
        floats_2d(table, row),
        integers_2d(table, row + 1),
        indices_2d(table, row + 2),
        floats_2d(table, row + 3),
        floats_2d(table, row + 4),
        indices_1d(table, row + 5),
        indices_1d(table, row + 6),
        indices_1d(table, row + 7),
    )


def certify(table, low, high):
    """Classify a range of the states of a motion as free, blocked or undecided.

    The last state is checked first, then the whole range, then its halves: an interval is free for
    a pair when the distance at its middle state exceeds the motion bound of the interval.

    Args:
        table: The address of `MotionArrays.table`. Its arrays are: the positions of the moving
            joints at the corners of a polyline, shape (C, M); where the corners are, in states,
            shape (C,); working memory; the undecided stretches that are found, their first and last
            state, shape (stretches, 2);
            the moving joint before each moving joint, or -1, shape (M,); each joint's pose on its
            parent at 0 (12), axis (3), 1 if prismatic, shape (M, 16); the poses of the bodies on
            their joints or in the world, shape (B, 12); the joint of each body or -1, its root, and
            1 if it is in the tree of objects, shape (B, 3); the lower and upper corner of its
            bounding box, shape (B, 6); its ball, shape (B, 4);
            the arrays of `tree_at` of all links, and those of all objects;
            the distances above which a pair is free and below which it is blocked, shape (K, 2);
            its two bodies and how many joints next to each of them move it relative to the other,
            shape (K, 4); where the joints of each body begin in the next array, shape (B + 1,); the
            moving joints that carry each body, tip first, shape (J,);
            and the working memory of `certificates._working_memory`.
        low: The number of the first state to classify.
        high: The number of the last state to classify.

    Returns:
        The number of undecided stretches; -1 - i where the state i is blocked; `FULL`.
    """
    corners, places = floats_2d(table, 0), floats_1d(table, 1)
    queue, found = integers_2d(table, 2), integers_2d(table, 3)
    parent, chain = integers_1d(table, 4), floats_2d(table, 5)
    body_poses, bodies, boxes = floats_2d(table, 6), integers_2d(table, 7), floats_2d(table, 8)
    balls, links, objects = floats_2d(table, 9), tree_at(table, 10), tree_at(table, 18)
    margins, checks = floats_2d(table, 26), indices_2d(table, 27)
    paths, joints = indices_1d(table, 28), indices_1d(table, 29)
    here, rates, poses = floats_1d(table, 30), floats_1d(table, 31), floats_2d(table, 32)
    body_at, middles, motions = floats_2d(table, 33), floats_2d(table, 34), floats_3d(table, 35)
    axes, scratch = floats_2d(table, 36), floats_2d(table, 37)
    body_stamp, stack, left = integers_1d(table, 38), indices_2d(table, 39), indices_1d(table, 40)
    width = corners.shape[1]
    total = checks.shape[0]
    for body in range(body_stamp.shape[0]):
        body_stamp[body] = -1
    room = total
    T, motion, ways = scratch[0], scratch[14], scratch[15:17]
    undecided = 0
    queue[0, 0], queue[0, 1], queue[0, 2], queue[0, 3] = high, high, 0, total
    head, tail = 0, 1
    if high > low:
        queue[1, 0], queue[1, 1], queue[1, 2], queue[1, 3] = low, high - 1, 0, total
        tail = 2
    while head < tail:
        low, high, begin, end = queue[head, 0], queue[head, 1], queue[head, 2], queue[head, 3]
        stamp = head
        head += 1
        middle = (low + high) // 2
        at = segment_of(places, middle)
        straight = places[at] <= low and high <= places[at + 1]
        segment, final = segment_of(places, low), segment_of(places, high)
        for m in range(width):
            rate = (corners[at + 1, m] - corners[at, m]) / (places[at + 1] - places[at])
            here[m] = corners[at, m] + rate * (middle - places[at])
            if straight:
                rates[m] = rate * max(high - middle, middle - low)
                continue
            widest = 0.0
            for k in range(segment, final + 1):
                rate = (corners[k + 1, m] - corners[k, m]) / (places[k + 1] - places[k])
                for side in range(2):
                    place = max(places[k], low) if side == 0 else min(places[k + 1], high)
                    there = corners[k, m] + rate * (place - places[k])
                    widest = max(widest, abs(there - here[m]))
            rates[m] = widest
        joint_poses(here, parent, chain, poses, scratch)
        kept = room
        share = room + (end - begin) <= left.shape[0]
        failed = 0
        is_open, is_contact = False, True
        for place in range(begin, end):
            check = left[place]
            for side in range(2):
                body = checks[check, side]
                if body_stamp[body] != stamp:
                    if bodies[body, 0] >= 0:
                        compose_transform(poses[bodies[body, 0]], body_poses[body], body_at[body])
                    else:
                        for i in range(12):
                            body_at[body, i] = body_poses[body, i]
                    u, v, w = balls[body, 0], balls[body, 1], balls[body, 2]
                    for i in range(3):
                        middles[body, i] = (
                            body_at[body, 3 * i] * u
                            + body_at[body, 3 * i + 1] * v
                            + body_at[body, 3 * i + 2] * w
                            + body_at[body, 9 + i]
                        )
                    if high > low:
                        body_motion(
                            rates, joints, paths[body], paths[body + 1], chain, poses,
                            middles[body, 0], middles[body, 1], middles[body, 2], balls[body, 3],
                            motions[body],
                        )  # fmt: skip
                    body_stamp[body] = stamp
            first, second = checks[check, 0], checks[check, 1]
            near, far = checks[check, 2], checks[check, 3]
            moved = motions[first, near, 8] + motions[second, far, 8] if high > low else 0.0
            free, blocked = margins[check, 0], margins[check, 1]
            x = middles[first, 0] - middles[second, 0]
            y = middles[first, 1] - middles[second, 1]
            z = middles[first, 2] - middles[second, 2]
            least = balls[first, 3] + balls[second, 3] + free + moved
            if x * x + y * y + z * z > least * least:
                continue
            is_free, is_hopeless = False, False
            for side in range(2):
                ball, body = (first, second) if side == 0 else (second, first)
                gap = box_gap(middles[ball], body_at[body], boxes[body], ways[side])
                radius = balls[ball, 3]
                ways[side, 3] = gap - radius - free
                if gap - radius > free:
                    is_free, is_hopeless = gap - radius - free > moved, moved > gap + radius
                    if is_free or is_hopeless:
                        break
            if is_free:
                continue
            answer = CLEAR_STATE
            if not is_hopeless:
                base = body_at[second]
                if high > low:
                    near_motion, far_motion = motions[first, near], motions[second, far]
                    relative_motion(near_motion, far_motion, straight, base, motion)
                    for side in range(2):
                        x, y, z = ways[side, 0], ways[side, 1], ways[side, 2]
                        is_free |= ways[side, 3] > 0.0 and ways[side, 3] > motion_along(
                            motion,
                            base[0] * x + base[3] * y + base[6] * z,
                            base[1] * x + base[4] * y + base[7] * z,
                            base[2] * x + base[5] * y + base[8] * z,
                        )
                    if is_free:
                        continue
                relative_transform(base, body_at[first], T)
                tree = links if bodies[first, 2] == 0 else objects
                other = links if bodies[second, 2] == 0 else objects
                answer = compare_trees(
                    tree, other, bodies[first, 1], bodies[second, 1], T, free, blocked,
                    high > low, motion, axes[check], stack, scratch,
                )  # fmt: skip
            if answer == FREE:
                continue
            if answer == BLOCKED:
                move_to_front(left, check)
                return -1 - middle
            if share:
                left[room + failed] = check
            failed += 1
            is_open |= answer == UNDECIDED
            is_contact &= blocked == -np.inf
        if failed == 0 or (high == low and not is_open):
            continue
        if high == low or (is_contact and high - low < CONTACT_STATES):
            found[undecided, 0], found[undecided, 1] = low, high
            undecided += 1
            continue
        if is_open:
            found[undecided, 0], found[undecided, 1] = middle, middle
            undecided += 1
        if tail + 2 > queue.shape[0]:
            return FULL
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
    return undecided
