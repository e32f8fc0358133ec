"""What plans a kind of motion that only some scenarios have, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from harness.core.details import Details
from harness.core.registry import Plugin
from harness.core.types import FloatArray
from harness.planning.cartesian.link_motion import LinkMotions
from harness.ports.motion_planning import MotionPlan


@dataclass(frozen=True, eq=False)
class ConstrainedMotion:
    """A motion under the path constraints of its planning call.

    Attributes:
        goals: Free group positions that satisfy the constraints, nearest first.
    """

    goals: Sequence[FloatArray]
    explanation: Details


class MotionKind(Plugin, ABC):
    """Plans motions of one kind, by the `kind` that they state."""

    plugin_kind: ClassVar[str] = "motion"

    @abstractmethod
    def plan(self, motion: Any, motions: LinkMotions) -> MotionPlan:
        """A verified motion.

        Args:
            motion: What is planned: one of `harness.ports.motions`, or a `ConstrainedMotion`.
            motions: The planning call, with its straight lines and arcs.

        Raises:
            PlanningFailed: It is not possible.
            TimingError: The arm cannot stand still where it starts, or at any goal.
        """
