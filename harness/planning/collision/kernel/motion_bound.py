"""Poses of the moving joints, and bounds of the motion of bodies over an interval."""

# Plain loops over arrays, no objects, no exceptions: numba compiles the functions below.
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

import math

from harness.planning.collision.kernel.compiling import compiled, inlined


@compiled
def compose_transform(first, second, out):
    """Product of two transforms, each rotation row by row, then translation."""
    for i in range(3):
        a, b, c = first[3 * i], first[3 * i + 1], first[3 * i + 2]
        for j in range(3):
            out[3 * i + j] = a * second[j] + b * second[3 + j] + c * second[6 + j]
        out[9 + i] = a * second[9] + b * second[10] + c * second[11] + first[9 + i]


@compiled
def relative_transform(base, other, out):
    """The transform of `other` relative to `base`."""
    x, y, z = other[9] - base[9], other[10] - base[10], other[11] - base[11]
    for i in range(3):
        a, b, c = base[i], base[3 + i], base[6 + i]
        for j in range(3):
            out[3 * i + j] = a * other[j] + b * other[3 + j] + c * other[6 + j]
        out[9 + i] = a * x + b * y + c * z


@compiled
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


@compiled
def body_motion(rates, path, first, last, chain, poses, x, y, z, radius, out):
    """How a ball moves when the joints before it, listed tip first, move by their rates.

    Args:
        rates: How far each joint moves to either end of the interval, with its sign.
        path: The joints, of which those from `first` to `last` carry the ball.
        out: Output, a row for each number of joints from the tip on that move: the first-order
            motion of the ball's centre (3), its rotation vector (3), its radius, a bound of the
            second-order motion of its points, and a bound of all motion.
    """
    moved = distal = second = 0.0
    vx = vy = vz = ox = oy = oz = 0.0
    for k in range(first, last):
        m = path[k]
        rate, w = rates[m], abs(rates[m])
        a = poses[m, 0] * chain[m, 12] + poses[m, 1] * chain[m, 13] + poses[m, 2] * chain[m, 14]
        b = poses[m, 3] * chain[m, 12] + poses[m, 4] * chain[m, 13] + poses[m, 5] * chain[m, 14]
        c = poses[m, 6] * chain[m, 12] + poses[m, 7] * chain[m, 13] + poses[m, 8] * chain[m, 14]
        if chain[m, 15] > 0.5:
            vx, vy, vz = vx + rate * a, vy + rate * b, vz + rate * c
            moved += w
            distal += w
        else:
            u, v, t = x - poses[m, 9], y - poses[m, 10], z - poses[m, 11]
            d, e, f = b * t - c * v, c * u - a * t, a * v - b * u
            vx, vy, vz = vx + rate * d, vy + rate * e, vz + rate * f
            ox, oy, oz = ox + rate * a, oy + rate * b, oz + rate * c
            lever = math.sqrt(u * u + v * v + t * t) + radius + moved
            moved += w * (math.sqrt(d * d + e * e + f * f) + radius + moved)
            second += w * (3.0 * distal + w * lever)
            distal += w * lever
        row = 1 + k - first
        out[row, 0], out[row, 1], out[row, 2] = vx, vy, vz
        out[row, 3], out[row, 4], out[row, 5] = ox, oy, oz
        out[row, 6], out[row, 7], out[row, 8] = radius, 0.5 * second, moved


@inlined
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


@compiled
def relative_motion(near, far, straight, base, out):
    """The motion of two bodies as `motion_along` needs it, in the frame of the second.

    Args:
        near: The motion of the first body relative to the second, a row of `body_motion`.
        far: The same of the second body.
        straight: Whether the interval is a straight line.
        base: The pose of the second body.
    """
    out[12] = near[8] + far[8]
    for i in range(12):
        out[i] = 0.0
    if not straight:
        out[11] = out[12]
        return
    for i in range(3):
        a, b, c = base[i], base[3 + i], base[6 + i]
        x, y, z = near[0] - far[0], near[1] - far[1], near[2] - far[2]
        out[i] = a * x + b * y + c * z
        out[3 + i] = a * near[3] + b * near[4] + c * near[5]
        out[6 + i] = a * far[3] + b * far[4] + c * far[5]
    out[9], out[10] = near[6], far[6]
    out[11] = near[7] + far[7]
