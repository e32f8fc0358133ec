"""What expectations about an object that is let go and lies still have in common."""

from __future__ import annotations

from typing import Any

from harness.core.types import BoolArray, FloatArray
from harness.judging.body_motion import STILL, body_speeds, calm, fastest_time
from harness.judging.contacts import TOUCH_FORCE, robot_contact
from harness.judging.margins import Part
from harness.judging.poses import object_poses, observed_for
from harness.judging.window import NotReached, Window
from harness.language.expectation import Quantity

SPEED = Quantity(
    "speed", "m/s", "of its fastest point at most `max_velocity`, for 50 ms too", "displacement"
)
TURNING = Quantity(
    "turning speed", "rad/s", "at most `max_angular_velocity`, and for 50 ms before", "displacement"
)
CONTACT = Quantity("contact with the robot", "N", "at most 0.001 N", "contact")
ATTACHED = Quantity("attached in the planning scene", "1", "not attached")


def still_part(
    window: Window,
    quantity: Quantity,
    speed: FloatArray,
    limit: float,
    here: BoolArray | None = None,
    **more: Any,
) -> Part:
    """A speed of the whole run that was at most `limit` in the last `STILL` seconds too.

    Args:
        speed: The speed at each sample of the run, shape (N,).
        limit: The largest speed that counts as rest.
        here: Samples at which its body is in the scene, as of `calm`.
    """
    return Part(
        quantity,
        window.cut(calm(window.run, speed, here)),
        limit,
        "<=",
        time_of=lambda index: fastest_time(window.run, speed, window.start + index),
        **more,
    )


def resting_parts(
    window: Window,
    name: str,
    limits: tuple[float, float],
    here: BoolArray | None = None,
    **more: Any,
) -> list[Part]:
    """The speeds of an object, at most the limits of speed [m/s] and of turning speed [rad/s]."""
    speeds = body_speeds(window.run, name, object_poses(window.run, name), here)
    return [
        still_part(window, quantity, speed, limit, here, **more)
        for quantity, speed, limit in zip((SPEED, TURNING), speeds, limits, strict=True)
    ]


def released_parts(window: Window, name: str) -> tuple[Part, Part]:
    """No contact with any link of the robot, and not attached in the planning scene."""
    force, hold = (window.cut(values) for values in robot_contact(window.run, name))
    return Part(CONTACT, force, TOUCH_FORCE, "<="), Part(ATTACHED, hold, 0.0, "==")


def rest_is_known(window: Window, here: BoolArray) -> BoolArray:
    """Where the speeds of `STILL` seconds before, `here` in the scene, are recorded."""
    judged = window.cut(observed_for(window.run, here, STILL))
    if window.cut(here).any() and not judged.any():
        soon = f"what stands still is known after {1000 * STILL:.0f} ms, not before"
        raise NotReached(window.cut_short or soon)
    return judged
