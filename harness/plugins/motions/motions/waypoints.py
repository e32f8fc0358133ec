"""The kind of motion `waypoints`."""

from __future__ import annotations

from typing import ClassVar

from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import MotionKind
from harness.plugins.motions.waypoint_plan import plan_waypoints
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import WaypointMotion


class WaypointKind(MotionKind):
    """Straight lines through waypoints, with rounded corners."""

    name: ClassVar[str] = "waypoints"

    def plan(self, motion: WaypointMotion, motions: LinkMotions) -> MotionPlan:
        """A verified motion of the group."""
        return plan_waypoints(motions, motion.goals, motion.path_options)
