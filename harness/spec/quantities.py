"""What each predicate measures, in which unit, and what it holds that against."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Quantity:
    """One number of a predicate.

    Attributes:
        name: As a verdict's measure is called, without the names of bodies in it.
        unit: Of the number and of the margin; `1` has none; several are joined by ` or `.
        holds: Where it holds.
    """

    name: str
    unit: str
    holds: str


JOINT = "rad or m"
TOUCH = "0.001 N"
JOINT_ERROR = (Quantity("joint position error", JOINT, "at most `tolerance`, for each joint"),)

QUANTITIES: Mapping[str, tuple[Quantity, ...]] = {
    "lifted": (
        Quantity("height gained", "m", "at least `above`; counts for nothing where another fails"),
        Quantity("finger force", "N", f"at least {TOUCH} on every side, from both sides"),
        Quantity(
            "other contact", "N", f"at most {TOUCH}, but with the gripper and what rests on it"
        ),
    ),
    "grasped": (
        Quantity("finger force", "N", "at least `min_force` on every side"),
        Quantity("between the fingers", "1", "pressed from both sides, and fits into the gap"),
        Quantity("slip in the hand", "m", "at most `max_slip`"),
        Quantity("turn in the hand", "rad", "at most `max_rotation`"),
    ),
    "released": (
        Quantity("contact with the robot", "N", f"at most {TOUCH}"),
        Quantity("attached in the planning scene", "1", "not attached"),
    ),
    "placed": (
        Quantity("support", "N", f"at least {TOUCH} from below, by what the robot does not hold"),
        Quantity("speed", "m/s", "at most `max_velocity`, and for 50 ms before"),
        Quantity("turning speed", "rad/s", "at most `max_angular_velocity`, and for 50 ms before"),
        Quantity("contact with the robot", "N", f"at most {TOUCH}"),
        Quantity("attached in the planning scene", "1", "not attached"),
        Quantity("position error", "m", "with `pose`: at most the tolerance's `position`"),
        Quantity("lean", "rad", "with `pose` and no tolerance: at most 0.1"),
        Quantity("orientation error", "rad", "with `tolerance`: at most its `orientation`"),
    ),
    "on": (Quantity("support from below", "N", "at least half of its weight"),),
    "in": (
        Quantity("distance inside", "m", "at least 0, to the nearest side of the outline"),
        Quantity("lean of the container", "rad", "at most `max_lean`"),
    ),
    "displaced": (Quantity("distance from the start", "m", "at least `at_least`"),),
    "upright": (Quantity("lean", "rad", "at most `tolerance`"),),
    "static": (
        Quantity("speed", "m/s", "at most `max_velocity`, and for 50 ms before"),
        Quantity("turning speed", "rad/s", "at most `max_angular_velocity`, and for 50 ms before"),
        Quantity("joint speed", "rad/s or m/s", "of everything: the same limits, for each joint"),
    ),
    "in_contact": (Quantity("contact force", "N", f"at least `min_force`, and {TOUCH}"),),
    "collision": (
        Quantity("contact force", "N", "more than 0 in a pair that nothing excuses; the largest"),
        Quantity(
            "clearance",
            "m",
            "where nothing collided: what was left, if it was recorded; where bodies overlap at the"
            " start: their depth, below 0",
        ),
    ),
    "clearance": (
        Quantity("clearance", "m", "at least `at_least`"),
        Quantity("clearance below plan", "m", "at most `max_below_plan`"),
    ),
    "tcp_pose": (
        Quantity("position error", "m", "at most the tolerance's `position`"),
        Quantity("orientation error", "rad", "at most its `orientation`, about each axis"),
    ),
    "tcp_path": (
        Quantity("deviation", "m", "at most `max_deviation`"),
        Quantity("share travelled forwards", "1", "at least `min_fraction`, in the whole window"),
    ),
    "joints": JOINT_ERROR,
    "named_target": JOINT_ERROR,
    "gripper": (
        *JOINT_ERROR,
        Quantity("gap error", "m", "with `width`: at most `tolerance`, 2 mm if not given"),
        Quantity("stalled", "1", "as `stalled` says"),
    ),
    "within_limits": (
        Quantity(
            "position", JOINT, "between the joint's limits, with a tolerance of 0.001 rad or 0.1 mm"
        ),
        Quantity("commanded position", JOINT, "between the joint's limits, without a tolerance"),
        Quantity(
            "velocity", "rad/s or m/s", "at most the joint's limit, with a tolerance of 0.1 %"
        ),
        Quantity("effort", "N m or N", "at most the joint's limit"),
        Quantity("acceleration", "rad/s^2 or m/s^2", "at most the joint's limit"),
    ),
    "tracking_error": (Quantity("tracking error", JOINT, "at most `max`, for each joint"),),
    "effort": (Quantity("effort", "1", "at most `max_fraction`, for each joint"),),
    "duration": (Quantity("duration", "s", "at most `at_most`, at least `at_least`"),),
    "path_length": (Quantity("path length", "m", "at most `at_most`, at least `at_least`"),),
    "fraction": (Quantity("fraction", "1", "at least `at_least`, for each path"),),
    "sees": (
        Quantity("pixels", "px", "at least `min_area`"),
        Quantity("visible share", "1", "of an object: at least `min_visible`"),
    ),
    "slip": (
        Quantity("slip against the planner", "m", "at most `max_distance`"),
        Quantity("turn against the planner", "rad", "at most `max_rotation`"),
    ),
}
"""Predicate -> its numbers. Verdicts name them so; tests hold the two together."""


def quantity_of(check: str, measure: str, unit: str) -> Quantity | None:
    """The quantity that a verdict's measure is one of; None if the predicate has no such number."""
    for quantity in sorted(QUANTITIES[check], key=lambda each: -len(each.name)):
        if quantity.name in measure and unit in quantity.unit.split(" or "):
            return quantity
    return None
