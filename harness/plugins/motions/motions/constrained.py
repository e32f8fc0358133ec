"""The kind of motion `constrained`."""

from __future__ import annotations

from typing import ClassVar

from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import ConstrainedMotion, MotionKind
from harness.planning.model.robot_model import GroupSpace
from harness.planning.verification.path_constraints import FindFrame
from harness.plugins.motions.constrained_motion import find_constrained_motion
from harness.plugins.motions.held_constraints import PathBands
from harness.ports.goals import PathConstraints
from harness.ports.motion_planning import MotionPlan


class ConstrainedKind(MotionKind):
    """A free motion that satisfies path constraints at every sample."""

    name: ClassVar[str] = "constrained"

    @staticmethod
    def bands(constraints: PathConstraints, space: GroupSpace, find_frame: FindFrame) -> PathBands:
        """Path constraints of a planning call.

        Raises:
            PlanningFailed: INVALID_LINK_NAME.
        """
        return PathBands(constraints, space, find_frame)

    def plan(self, motion: ConstrainedMotion, motions: LinkMotions) -> MotionPlan:
        """A verified motion of the group."""
        task = motions.task
        assert isinstance(task.held, PathBands)
        return find_constrained_motion(task, task.held, motion.goals, motion.explanation)
