"""The kind of motion `constrained`."""

from __future__ import annotations

from typing import ClassVar

from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import ConstrainedMotion, MotionKind
from harness.plugins.motions.constrained_motion import find_constrained_motion
from harness.ports.motion_planning import MotionPlan


class ConstrainedKind(MotionKind):
    """A free motion that satisfies path constraints at every sample."""

    name: ClassVar[str] = "constrained"

    def plan(self, motion: ConstrainedMotion, motions: LinkMotions) -> MotionPlan:
        """A verified motion of the group."""
        task = motions.task
        assert task.held is not None
        return find_constrained_motion(task, task.held, motion.goals, motion.explanation)
