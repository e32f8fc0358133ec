"""Numbers of an explanation as a person reads them, each with its unit."""

from __future__ import annotations

from collections.abc import Sequence, Sized

import numpy as np

from harness.core.types import FloatArray
from harness.planning.robot_model import GroupSpace
from harness.ports import Touch

MOST_TOUCHES = 3
"""Pairs that are named; of the rest only how many they are."""


def length(metres: float) -> str:
    """`12.3 mm`, or `1.23 m`."""
    return f"{1000 * metres:.1f} mm" if abs(metres) < 1.0 else f"{metres:.2f} m"


def angle(radians: float) -> str:
    """`20.0°`, finer where that would say nothing."""
    degrees = float(np.degrees(radians))
    return f"{degrees:.1f}°" if abs(degrees) >= 0.05 else f"{degrees:.2g}°"


def point(xyz: FloatArray) -> str:
    """`(0.320, -0.170, 1.320)`, without a negative zero."""
    return "(" + ", ".join(f"{round(float(value), 3) + 0.0:.3f}" for value in xyz) + ")"


def joint_value(space: GroupSpace, joint: str, value: float) -> str:
    """A joint's position in its unit: `2.100 rad (120.3°)`, `12.0 mm`."""
    if space.wraps[space.joint_names.index(joint)]:
        return f"{value:.3f} rad ({angle(value)})"
    return length(value)


def touch(item: Touch) -> str:
    """`forearm_link and Table (12.3 mm deep)`."""
    how = "deep" if item.distance < 0 else "apart"
    return f"{item.first} and {item.second} ({length(abs(item.distance))} {how})"


def touches(items: Sequence[Touch], most: int = MOST_TOUCHES) -> str:
    """The nearest pairs, and how many more there are."""
    more = len(items) - most
    rest = f" and {count(more, 'more pair')}" if more > 0 else ""
    return ", ".join(map(touch, items[:most])) + rest


def count(things: Sized | int, noun: str) -> str:
    """`1 way`, `2 ways`; `branch` gets its `es`."""
    number = things if isinstance(things, int) else len(things)
    plural = f"{noun}es" if noun.endswith(("ch", "s")) else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"
