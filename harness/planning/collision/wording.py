"""Numbers of an explanation as a person reads them, each with its unit."""

from __future__ import annotations

from collections.abc import Sequence, Sized

import numpy as np

from harness.core.quantity import distinct
from harness.core.types import FloatArray
from harness.planning.model.robot_model import GroupSpace
from harness.ports.scene import Touch

MOST_TOUCHES = 3  # Pairs that are named; of the rest only how many they are


def length_text(metres: float, more_digits: int = 0) -> str:
    """`12.3 mm`, or `1.23 m`."""
    if abs(metres) < 1.0:
        return f"{1000 * metres:.{1 + more_digits}f} mm"
    return f"{metres:.{2 + more_digits}f} m"


def angle(radians: float) -> str:
    """`20.0°`, finer where that would say nothing."""
    degrees = float(np.degrees(radians))
    return f"{degrees:.1f}°" if abs(degrees) >= 0.05 else f"{degrees:.2g}°"


def point(xyz: FloatArray) -> str:
    """`(320, -170, 1320) mm`."""
    return f"({', '.join(str(round(1000 * float(value))) for value in xyz)}) mm"


def joint_value(space: GroupSpace, joint: str, value: float) -> str:
    """A joint's position in its unit: `2.100 rad (120.3°)`, `12.0 mm`."""
    if space.wraps[space.joint_names.index(joint)]:
        return f"{value:.3f} rad ({angle(value)})"
    return length_text(value)


def touch(item: Touch) -> str:
    """`forearm_link and Table (12.3 mm deep)`, `rh_l2 and cube (13.5 mm apart, 25.0 mm required)`.

    The digits show that the distance is smaller than the required one.
    """
    names = f"{item.first} and {item.second}"
    if item.distance < 0:
        return f"{names} ({length_text(-item.distance)} deep)"
    if item.required <= item.distance:
        return f"{names} ({length_text(item.distance)} apart)"
    distance, required = distinct(item.distance, item.required, length_text)
    return f"{names} ({distance} apart, {required} required)"


def touches(items: Sequence[Touch], most: int = MOST_TOUCHES) -> str:
    """The nearest pairs, and how many more there are."""
    more = len(items) - most
    rest = f" and {counted_noun(more, 'more pair')}" if more > 0 else ""
    return ", ".join(map(touch, items[:most])) + rest


def counted_noun(things: Sized | int, noun: str) -> str:
    """`1 way`, `2 ways`; `branch` gets its `es`."""
    number = things if isinstance(things, int) else len(things)
    plural = f"{noun}es" if noun.endswith(("ch", "s")) else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"
