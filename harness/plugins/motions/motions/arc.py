"""The kind of motion `arc`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from harness.core.details import Detail, Details
from harness.core.types import Floats
from harness.planning.cartesian.line_goals import end_pose
from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import MotionKind
from harness.plugins.motions.circular_path import arc_to
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import CircularMotion


@dataclass(frozen=True)
class ArcResult(Detail):
    """The circle of an arc [m], and the angle that it sweeps [rad]."""

    center: Floats
    radius: float
    sweep: float


class ArcKind(MotionKind):
    """Pilz's CIRC: an arc through a point or about a centre."""

    name: ClassVar[str] = "arc"

    def plan(self, motion: CircularMotion, motions: LinkMotions) -> MotionPlan:
        """A verified motion of the group."""
        start = motions.task.start
        target = end_pose(motions.kinematics, motions.task, start, motion.goal)
        arc = arc_to(target, motions.pose(start, target.link), motion.point)
        circle = ArcResult(tuple(arc.center.tolist()), arc.radius, arc.sweep)
        return motions.to_end(arc, target, "CIRC", Details.of(circle))
