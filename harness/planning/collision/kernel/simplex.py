"""The point of a simplex that is nearest to the origin."""

# Plain loops over arrays, no objects, no exceptions: numba compiles the functions below.
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

import math

import numpy as np

from harness.planning.collision.kernel.compiling import compiled


@compiled
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


@compiled
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


@compiled
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
