"""Follows belts and turntables."""

from __future__ import annotations

from typing import ClassVar

from harness.plugins.belts.moving_frames import execute_motion
from harness.plugins.belts.pick_in_motion import pick_in_motion
from harness.plugins.belts.place_in_motion import place_in_motion
from harness.steps._tracker import Tracker


class BeltTracker(Tracker):
    """Follow an object, or a place, on a belt or a turntable, whose motion is known."""

    name: ClassVar[str] = "belt"
    execute = staticmethod(execute_motion)
    pick = staticmethod(pick_in_motion)
    place = staticmethod(place_in_motion)
