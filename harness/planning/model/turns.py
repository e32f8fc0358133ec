"""How far rotations are turned from another one, about the axes of that one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.pose_arrays import quats_from_rotations, rotation_vector
from harness.core.types import FloatArray

FREE = np.pi - 1e-6  # A tolerance about one axis from which on any turn about it is allowed [rad]


def free_axis(tolerance: Sequence[float]) -> int | None:
    """The only axis about which any turn is allowed; None where it is none or several."""
    free = [axis for axis in range(3) if tolerance[axis] >= FREE]
    return free[0] if len(free) == 1 else None


def turns_from(middle: FloatArray, rotations: FloatArray, tolerance: Sequence[float]) -> FloatArray:
    """How rotations are turned away from a middle one, about the middle's axes [rad], shape (N, 3).

    The rotation vector; where one axis alone is free, the vector of what is left when the turn
    about that axis is taken out, so that a cone about it stays a cone however far it is turned.

    Args:
        middle: The rotation from which turns are measured, shape (3, 3).
        tolerance: The tolerance about x, y, z [rad], which says which axes are free.
    """
    relative = middle.T @ rotations
    axis = free_axis(tolerance)
    if axis is None:
        return rotation_vector(quats_from_rotations(relative))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    sines = np.hypot(relative[:, first, axis], relative[:, second, axis])
    angles = np.arctan2(sines, relative[:, axis, axis])
    swings = np.zeros((len(relative), 3))
    scale = angles / np.maximum(sines, 1e-300)
    swings[:, first] = -scale * relative[:, second, axis]
    swings[:, second] = np.where(sines > 0, scale * relative[:, first, axis], angles)
    return swings


def is_within(turn: FloatArray, tolerance: Sequence[float]) -> bool:
    """Whether a turn keeps the tolerances about all axes that are not free."""
    return all(
        limit >= FREE or abs(angle) <= limit + 1e-9
        for angle, limit in zip(turn, tolerance, strict=True)
    )
