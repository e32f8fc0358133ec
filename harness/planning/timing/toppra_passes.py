"""TOPP-RA's two passes, over linear programs in the squared rates at both ends of each step.

With x and y the squares of the parameter's rate at the start and the end of a step of length h, its
acceleration is (y - x) / 2h, so every bound is a half-plane of x and y, and so are x >= 0, y >= 0.
Standing still is possible everywhere: the origin is in all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.native.library import call

LARGEST_SQUARE = 1e8
"""Bounds a squared rate [1/s^2] where nothing else does: 10,000 lengths of the parameter's unit."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """|speeds u + bends x + offsets| <= most at every grid point, and x <= rate_squared.

    x is the square of the parameter's rate and u its acceleration.

    Attributes:
        speeds: The factors of u, shape (M, k), like `bends` of x and `offsets`.
        most: The largest magnitudes, shape (k,).
        rate_squared: The largest x, shape (M,); None for no bound.
        between: Whether the bounds of a grid point hold at the next one too, as it is approached.
    """

    speeds: FloatArray
    bends: FloatArray
    offsets: FloatArray
    most: FloatArray
    rate_squared: FloatArray | None = None
    between: bool = True


def half_planes(bounds: Sequence[Bounds], grid: FloatArray) -> tuple[FloatArray, ...]:
    """Half-planes: now x + after y <= room, (N, m) each; (now, after) has length 1."""
    step = 2 * np.diff(grid)[:, None]
    one, none = np.ones_like(step), np.zeros_like(step)
    largest = np.full(len(grid), LARGEST_SQUARE)
    for each in bounds:
        if each.rate_squared is not None:
            largest = np.minimum(largest, each.rate_squared)
    # x is at most its bound, and y at least zero.
    parts = [(one, none, largest[:-1, None]), (none, -one, none)]
    for each in bounds:
        speeds, bends, offsets = each.speeds, each.bends, each.offsets
        rows = [(step * bends[:-1] - speeds[:-1], speeds[:-1], offsets[:-1])]
        if each.between:
            rows.append((-speeds[1:], speeds[1:] + step * bends[1:], offsets[1:]))
        for now, after, offset in rows:
            parts.append((now, after, step * (each.most - offset)))
            parts.append((-now, -after, step * (each.most + offset)))
    now, after, room = (np.hstack(columns) for columns in zip(*parts, strict=True))
    length = np.hypot(now, after)
    length[length == 0.0] = 1.0  # nothing moves: the bound is of the offset alone
    return now / length, after / length, room / length


def squared_rates(bounds: Sequence[Bounds], grid: FloatArray) -> FloatArray | None:
    """The largest squares of the parameter's rate at grid points (N + 1,), at rest at both ends.

    Args:
        bounds: Bounds under which standing still is possible at every grid point.
        grid: The parameter, ascending, shape (N + 1,).

    Returns:
        None where there is no solution.

    References:
        H. Pham, Q.-C. Pham, "A New Approach to Time-Optimal Path Parameterization Based on
        Reachability Analysis", IEEE T-RO 34(3), 2018.
    """
    planes = half_planes(bounds, grid)
    if not np.all(planes[-1] >= 0):
        return None
    return call("squared_rates", planes, np.empty(len(grid)))
