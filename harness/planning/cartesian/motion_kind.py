"""What plans a kind of motion that only some scenarios have, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

from harness.core.registry import Plugin
from harness.planning.cartesian.link_motion import LinkMotions
from harness.ports.motion_planning import MotionPlan


class MotionKind(Plugin, ABC):
    """Plans motions of one kind, by the `kind` that they state."""

    plugin_kind: ClassVar[str] = "motion"

    @abstractmethod
    def plan(self, motion: Any, motions: LinkMotions) -> MotionPlan:
        """A verified motion.

        Args:
            motion: What is planned, one of `harness.ports.motions`.
            motions: The planning call, with its straight lines and arcs.

        Raises:
            PlanningFailed: It is not possible.
        """
