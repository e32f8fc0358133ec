"""Adds to a failed planning call why it failed, and to a failed step what to do, by plug-ins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Generator
from contextlib import contextmanager
from typing import ClassVar

from harness.cell.cell import Cell
from harness.core.details import Details
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.registry import Plugin, registry
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.ports.motion_planning import MotionRequest
from harness.recording.explanation import Explanation

_NO_STAGE = ("INVALID_GROUP_NAME", "INVALID_LINK_NAME", "UNRECOGNIZED_GOAL_TYPE", "CRASH")


class Explainer(Plugin, ABC):
    """Explains why something failed; of several, the first by name does so."""

    plugin_kind: ClassVar[str] = "explainer"

    @abstractmethod
    def explain(
        self,
        failure: PlanningFailed,
        request: MotionRequest,
        scene: CoalScene,
        kinematics: PinocchioKinematics,
    ) -> Explanation:
        """The result of each planning stage, in order, and what to do."""

    def advice(self, failure: StepFailed, cell: Cell) -> str:
        """What to do about a failed step that has no explanation; empty where nothing is known."""
        del failure, cell
        return ""


@contextmanager
def explained(
    request: MotionRequest, scene: CoalScene, kinematics: PinocchioKinematics
) -> Generator[None]:
    """Add an Explanation to the details of a failure."""
    try:
        yield
    except PlanningFailed as failure:
        has_stage = failure.code not in _NO_STAGE and request.options.is_explained
        for explainer in registry(Explainer.plugin_kind).values() if has_stage else ():
            if failure.details.find(Explanation) is None:
                explanation = explainer().explain(failure, request, scene, kinematics)
                failure.details += Details.of(explanation)
        raise
