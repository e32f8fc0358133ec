"""The free pose nearest to a goal in collision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik.numeric import LinkGoal
from harness.ports.goals import PositionGoal

SHIFTS = (0.01, 0.02, 0.04, 0.08, 0.16)
"""How far a goal in collision is moved in search of a free place [m]."""

_SHORTEST_SHIFT = 0.001  # [m] how finely the way to the free place is halved


def nearest_free_shift(
    goal: LinkGoal, solve: Callable[[LinkGoal], Sequence[FloatArray]], is_free: Callable[..., bool]
) -> tuple[FloatArray, FloatArray] | None:
    """The shortest move of a goal, along a world axis or away, that frees it.

    Args:
        goal: The goal, in collision in each of its solutions.

    Returns:
        The move [m], shape (3,), and free group positions there; None when no place within the
        longest of `SHIFTS` is free.
    """

    def free_at(shift: FloatArray) -> FloatArray | None:
        return next((q for q in solve(_moved(goal, shift)) if is_free(q)), None)

    directions = np.array(
        [(0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1)], dtype=float
    )
    for number, far in enumerate(SHIFTS):
        near = SHIFTS[number - 1] if number else 0.0
        found = [(axis, free_at(far * axis)) for axis in directions]
        free = [(axis, positions) for axis, positions in found if positions is not None]
        if free:
            ways = [_halved(axis, positions, near, far, free_at) for axis, positions in free]
            return min(ways, key=lambda way: round(float(np.linalg.norm(way[0])), 6))
    return None


def _halved(
    axis: FloatArray,
    positions: FloatArray,
    near: float,
    far: float,
    free_at: Callable[[FloatArray], FloatArray | None],
) -> tuple[FloatArray, FloatArray]:
    """The shortest free move along an axis between one that is not and one that is."""
    while far - near > _SHORTEST_SHIFT:
        middle = 0.5 * (near + far)
        found = free_at(middle * axis)
        if found is None:
            near = middle
        else:
            far, positions = middle, found
    return far * axis, positions


def _moved(goal: LinkGoal, shift: FloatArray) -> LinkGoal:
    if isinstance(goal, PositionGoal):
        return replace(goal, position=goal.position + shift)
    return replace(goal, pose=SE3(goal.pose.rotation, goal.pose.translation + shift))
