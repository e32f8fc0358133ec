"""How far one rotation is turned from another, about the axes of the first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.spatial import quat_wxyz_from_rotation
from harness.core.types import FloatArray

FREE = np.pi - 1e-6
"""A tolerance about one axis from which on any turn about it is allowed [rad]."""


def turn_from(middle: FloatArray, rotation: FloatArray, tolerance: Sequence[float]) -> FloatArray:
    """How a rotation is turned away from a middle one, about the middle's axes [rad], shape (3,).

    The rotation vector; where one axis alone is free, the vector of what is left when the turn
    about that axis is taken out, so that a cone about it stays a cone however far it is turned.

    Args:
        middle: The rotation from which the turn is measured, shape (3, 3).
        rotation: The rotation at the end of the turn, shape (3, 3).
        tolerance: The tolerance about x, y, z [rad], which says which axes are free.
    """
    quat = quat_wxyz_from_rotation(middle.T @ rotation)
    free = [axis for axis in range(3) if tolerance[axis] >= FREE]
    if len(free) != 1:
        return _rotation_vector(quat)
    axis = free[0]
    w, v = quat[0], quat[1:]
    size = float(np.hypot(w, v[axis]))
    if size < 1e-9:
        return _rotation_vector(quat)
    cosine, sine = w / size, v[axis] / size
    unit = np.eye(3)[axis]
    swing_vector = cosine * v - sine * w * unit - np.cross(v, sine * unit)
    return _rotation_vector(np.concatenate([[cosine * w + sine * v[axis]], swing_vector]))


def is_within(turn: FloatArray, tolerance: Sequence[float]) -> bool:
    """Whether a turn keeps the tolerances about all axes that are not free."""
    return all(
        limit >= FREE or abs(angle) <= limit + 1e-9
        for angle, limit in zip(turn, tolerance, strict=True)
    )


def _rotation_vector(quat_wxyz: FloatArray) -> FloatArray:
    size = float(np.linalg.norm(quat_wxyz[1:]))
    if size < 1e-12:
        return np.zeros(3)
    angle = 2 * np.arctan2(size, abs(quat_wxyz[0]))
    return np.sign(quat_wxyz[0] or 1.0) * angle * quat_wxyz[1:] / size
