"""Limits of expectations that every run keeps, or that none does."""

from __future__ import annotations

import numpy as np

from harness.cell.scope import At
from harness.core.pose_arrays import angle_between, rotate
from harness.core.world import STRAY, ObjectJoint
from harness.judging.margins import Comparison
from harness.judging.poses import UP

Ends = tuple[float, float]  # the least and the largest value
UNITS_HINT = "angles without a unit are in radians, lengths in metres"
BEYOND_STOPS = 0.1  # share of a joint's range by which it may be pushed beyond its stops
LEANS = 1000  # positions of a hinge at which the lean of its part is calculated


def refuse_decided(
    at: At,
    key: str,
    comparison: Comparison,
    limit: float,
    ends: Ends,
    of: str,
    hint: str = UNITS_HINT,
) -> None:
    """Report a limit that is not between the ends of what it limits.

    Args:
        comparison: How a value must stand to the limit for the expectation to hold.
        ends: The least and the largest value in any run.
        of: What is limited, as the subject of a sentence.
    """
    low, high = ends
    if low <= limit < high if comparison == "<=" else low < limit <= high:
        return
    message = f"{of} is between {low:.3g} and {high:.3g}, so that this is decided without a run"
    at.scope.problems.add(at.key(key), message, hint)


def error_range(target: float, lower: float, upper: float) -> Ends:
    """The least and the largest distance of a position from a target, given its stops."""
    beyond = max(lower - target, target - upper) - BEYOND_STOPS * (upper - lower)
    return max(0.0, beyond), max(upper - target, target - lower)


def lean_range(joint: ObjectJoint) -> Ends:
    """The smallest and the largest lean of a part of a fixture [rad]."""
    beyond, room = BEYOND_STOPS * (joint.upper - joint.lower), STRAY[1]
    positions = np.linspace(joint.lower - beyond, joint.upper + beyond, LEANS)
    leans = angle_between(rotate(joint.poses(positions)[:, 3:], UP), UP)
    return max(0.0, float(leans.min()) - room), float(leans.max()) + room
