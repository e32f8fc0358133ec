"""The kind of motion `sequence`."""

from __future__ import annotations

from typing import ClassVar

from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import MotionKind
from harness.plugins.motions.sequence_plan import plan_items
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import MotionSequence


class SequenceKind(MotionKind):
    """Motions that blend into each other."""

    name: ClassVar[str] = "sequence"

    def plan(self, motion: MotionSequence, motions: LinkMotions) -> MotionPlan:
        """A verified motion of the group."""
        return plan_items(motions, motion.items)
