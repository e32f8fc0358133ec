"""How an object may be turned about the vertical and look the same."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.core.geometry import Box, Capsule, Cylinder, Shape, Sphere
from harness.core.types import FloatArray

LEAN = 1e-6
"""A unit vector that stands so much less high than 1 is still vertical."""
ASIDE = 1e-4
"""A shape whose middle is so far from the vertical through the origin is still on it [m]."""

ANY = 0
"""What `equal_turns` answers for what is round."""


def equal_turns(shapes: Sequence[Shape], rotation: FloatArray) -> int:
    """How many turns about the vertical through its origin leave an object as it stands.

    Two for a box that stands on a side, four where that side is square, `ANY` for what is round
    about the vertical, one (the whole turn) for everything else.

    Args:
        shapes: Of the object.
        rotation: R_world_object as it stands, shape (3, 3).
    """
    if not shapes:
        return 1
    return math.gcd(*(_turns_of(shape, rotation) for shape in shapes))  # gcd(ANY, n) is n


def _turns_of(shape: Shape, rotation: FloatArray) -> int:
    if math.hypot(*(rotation @ shape.pose.translation)[:2]) > ASIDE:
        return 1
    if isinstance(shape.geometry, Sphere):
        return ANY
    heights = abs((rotation @ shape.pose.rotation)[2])
    vertical = int(heights.argmax())
    if heights[vertical] < 1 - LEAN:
        return 1
    match shape.geometry:
        case Box(size=size):
            first, second = (length for axis, length in enumerate(size) if axis != vertical)
            return 4 if math.isclose(first, second) else 2
        case Cylinder() | Capsule():
            return ANY if vertical == 2 else 2
        case _:
            return 1
