"""Poses and numbers for world files, without rounding errors."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from pydantic import ValidationError

from harness.core.spatial import SE3, rotation_from_quat_wxyz, rotation_from_rpy
from harness.core.types import FloatArray
from harness.language.poses import Pose

DECIMALS = 12  # Decimals of metres and quaternion components; finer differences are rounding errors


def rounded(value: float) -> float:
    """A number rounded to `DECIMALS`, without negative zero."""
    return round(float(value), DECIMALS) + 0.0


def significant(value: float) -> float:
    """A mass or moment rounded to twelve significant digits."""
    return float(f"{value:.12g}") + 0.0


def pose_spec(pose: SE3) -> Pose:
    """A pose for a file; an identity rotation is omitted."""
    x, y, z = (rounded(value) for value in pose.translation)
    if np.allclose(pose.rotation, np.eye(3), rtol=0, atol=1e-12):
        return Pose(xyz=(x, y, z))
    a, b, c, d = (rounded(value) for value in pose.quat_wxyz)
    return Pose(xyz=(x, y, z), quat_wxyz=(a, b, c, d))


def facing(normal: FloatArray) -> FloatArray:
    """The shortest rotation from z to a unit vector, shape (3, 3)."""
    x, y, z = normal
    if z < -1 + 1e-12:
        return rotation_from_rpy((math.pi, 0.0, 0.0))
    return rotation_from_quat_wxyz((1 + z, -y, x, 0.0))


LEAST_NORMAL = 1e-9  # Length of the normal of a plane below which it has no direction
THICK_PLANE = "a plane is solid below its surface; MoveIt's is thin"


def plane_pose(coefficients: Sequence[float]) -> SE3:
    """The frame of a x + b y + c z + d = 0, z along its normal."""
    *normal, offset = coefficients
    length = math.hypot(*normal)
    unit = np.array(normal) / length
    return SE3(facing(unit), -offset / length * unit)


def first_mistake(error: ValidationError) -> str:
    """The first value that a model refuses: its keys, and what is wrong with it."""
    first = error.errors(include_url=False)[0]
    return f"{'.'.join(map(str, first['loc']))}: {first['msg'].removeprefix('Value error, ')}"
