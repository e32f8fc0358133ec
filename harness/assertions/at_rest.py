"""What expectations about an object that is let go and lies still have in common."""

from __future__ import annotations

from harness.assertions.contacts import TOUCH_FORCE, robot_contact
from harness.assertions.margins import Part
from harness.assertions.poses import STILL, observed_for
from harness.assertions.window import NotReached, Window
from harness.core.types import BoolArray
from harness.language.expectation import Quantity

SPEED = Quantity(
    "speed", "m/s", "of its fastest point at most `max_velocity`, for 50 ms too", "displacement"
)
TURNING = Quantity(
    "turning speed", "rad/s", "at most `max_angular_velocity`, and for 50 ms before", "displacement"
)
CONTACT = Quantity("contact with the robot", "N", "at most 0.001 N", "contact")
ATTACHED = Quantity("attached in the planning scene", "1", "not attached")


def released_parts(window: Window, name: str) -> tuple[Part, Part]:
    """No contact with any link of the robot, and not attached in the planning scene."""
    force, hold = (window.cut(values) for values in robot_contact(window.run, name))
    return Part(CONTACT, force, TOUCH_FORCE, "<="), Part(ATTACHED, hold, 0.0, "==")


def rest_is_known(window: Window, here: BoolArray) -> BoolArray:
    """Where the speeds of `STILL` seconds before are recorded, in the window or before it.

    Args:
        window: The window that is judged.
        here: Where the object is present, for the whole run.

    Raises:
        NotReached: They are not at any sample.
    """
    judged = window.cut(observed_for(window.run, here, STILL))
    if window.cut(here).any() and not judged.any():
        soon = f"what stands still is known after {1000 * STILL:.0f} ms, not before"
        raise NotReached(window.cut_short or soon)
    return judged
