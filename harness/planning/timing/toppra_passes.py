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

LARGEST_SQUARE = 1e8
"""Bounds a squared rate [1/s^2] where nothing else does: 10,000 lengths of the parameter's unit."""

PARALLEL = 1e-12
"""Sine of an angle between lines up to which they have no intersection: rounding of directions."""

LARGEST_RESERVE, RESERVED_SHARE = 1e-8, 1e-4
"""How much slower than possible each step of the second pass ends: at most [1/s^2], and as a share.

At the largest rate itself only one acceleration is left, by which the motion may even have to stop.
"""


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


@dataclass(frozen=True, eq=False)
class HalfPlanes:
    """now x + after y <= room for each step and bound, shape (N, m); (now, after) has length 1."""

    now: FloatArray
    after: FloatArray
    room: FloatArray

    @classmethod
    def of(cls, bounds: Sequence[Bounds], grid: FloatArray) -> HalfPlanes:
        """Half-planes of bounds on the steps between grid points (N + 1,)."""
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
        return cls(now / length, after / length, room / length)

    def peaks(self) -> tuple[FloatArray, FloatArray]:
        """The points x and y of each step's polygon that have the largest x, (N,) each.

        All steps walk along the edges at once, counterclockwise from the origin, while x grows.
        """
        found = np.zeros((len(self.room), 2))
        direction = np.tile([1.0, 0.0], (len(self.room), 1))
        steps = np.arange(len(self.room))  # those whose walk goes on
        while len(steps):
            now, after = self.now[steps], self.after[steps]
            x, y = found[steps].T[:, :, None]
            along_x, along_y = direction[steps].T[:, :, None]
            speed = now * along_x + after * along_y
            left = np.maximum(self.room[steps] - now * x - after * y, 0.0)
            with np.errstate(divide="ignore", invalid="ignore"):
                ways = np.where(speed > PARALLEL, left / speed, np.inf)
            edge = np.argmin(ways, axis=1)
            way = ways[np.arange(len(steps)), edge]
            found[steps] += way[:, None] * direction[steps]
            direction[steps] = np.column_stack([-self.after[steps, edge], self.now[steps, edge]])
            steps = steps[direction[steps, 0] > PARALLEL]
        return found[:, 0], found[:, 1]


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
    planes = HalfPlanes.of(bounds, grid)
    if not np.all(planes.room >= 0):
        return None
    found = _controllable(planes)
    room, share = _intercepts(planes.after, planes.now, planes.room)
    found[0] = 0.0
    for row in range(len(room)):
        reached = min(found[row + 1], (room[row] - share[row] * found[row]).min())
        reached -= min(LARGEST_RESERVE, RESERVED_SHARE * reached)
        found[row + 1] = max(0.0, reached)  # rounding may leave less than nothing
    return found


def _controllable(planes: HalfPlanes) -> FloatArray:
    """The first pass: the largest squared rates from which rest at the end can be reached."""
    peak, peak_after = (values.tolist() for values in planes.peaks())
    room, share = _intercepts(planes.now, planes.after, planes.room)
    found = np.zeros(len(peak) + 1)
    after = 0.0
    for row in range(len(peak) - 1, -1, -1):
        is_free = peak_after[row] <= after
        after = peak[row] if is_free else max(0.0, (room[row] - share[row] * after).min())
        found[row] = after
    return found


def _intercepts(
    of: FloatArray, other: FloatArray, room: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Values whose `room - share * other` bounds a coordinate from above, shape (N, m) each."""
    bounds = of > PARALLEL
    factor = np.where(bounds, of, 1.0)
    return np.where(bounds, room / factor, np.inf), np.where(bounds, other / factor, 0.0)
