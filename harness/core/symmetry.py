"""Rotational symmetry of objects about the vertical."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.core.geometry import Box, Capsule, Cylinder, Shape, Sphere
from harness.core.types import FloatArray

TILT_TOLERANCE = 1e-6  # of the z component of a vertical unit vector from 1
AXIS_TOLERANCE = 1e-4  # [m], of a symmetric shape's centre from the origin's vertical
ANY = 0  # of an object that is round about the vertical


def equal_turns(shapes: Sequence[Shape], rotation: FloatArray) -> int:
    """Order of an object's rotational symmetry about the vertical through its origin.

    It is two for a box that rests on a side, four where that side is square, `ANY` for an object
    that is round about the vertical, and one (the full turn) for everything else.

    Args:
        rotation: R_world_object, shape (3, 3).
    """
    if not shapes:
        return 1
    return math.gcd(*(_turns_of(shape, rotation) for shape in shapes))  # gcd(ANY, n) is n


def _turns_of(shape: Shape, rotation: FloatArray) -> int:
    if math.hypot(*(rotation @ shape.pose.translation)[:2]) > AXIS_TOLERANCE:
        return 1
    if isinstance(shape.geometry, Sphere):
        return ANY
    heights = abs((rotation @ shape.pose.rotation)[2])
    vertical = int(heights.argmax())
    if heights[vertical] < 1 - TILT_TOLERANCE:
        return 1
    match shape.geometry:
        case Box(size=size):
            first, second = (length for axis, length in enumerate(size) if axis != vertical)
            return 4 if math.isclose(first, second) else 2
        case Cylinder() | Capsule():
            return ANY if vertical == 2 else 2
        case _:
            return 1
