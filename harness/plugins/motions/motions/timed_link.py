"""The kind of motion `timed_link`."""

from __future__ import annotations

from typing import ClassVar

from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import MotionKind
from harness.plugins.motions.timed_link_plan import plan_timed_link
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import TimedLinkMotion


class TimedLinkKind(MotionKind):
    """A link that is at a pose at each moment."""

    name: ClassVar[str] = "timed_link"

    def plan(self, motion: TimedLinkMotion, motions: LinkMotions) -> MotionPlan:
        """A verified motion of the group."""
        return plan_timed_link(motions.task, motion)
