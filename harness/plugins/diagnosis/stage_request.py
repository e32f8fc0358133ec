"""The input and the output of the stages that explain a failed planning call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.nearest_pose import NearestPose
from harness.planning.ik.numeric import LinkGoal
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import Goal, PoseGoal
from harness.ports.motion_planning import PlanningOptions
from harness.ports.scene import Touch
from harness.recording.explanation import NearestState, Stage


@dataclass(frozen=True, eq=False)
class StageFinding:
    """A stage's result, with additional data for the report.

    Attributes:
        nearest: A state to draw; None where there is none.
        advice: What to do if this is the first failed stage.
    """

    stage: Stage
    nearest: NearestState | None = None
    advice: str = ""


@dataclass(frozen=True, eq=False)
class StageRequest:
    """A failed planning call.

    Attributes:
        space: The group, with the other joints at the start state.
        start: The start positions in description order.
        goal: The goal; None for a motion without one, such as a relative motion.
        checker: The checker of the motion's states; None where the motion cannot begin.
    """

    failure: PlanningFailed
    kinematics: PinocchioKinematics
    scene: CoalScene
    space: GroupSpace
    start: FloatArray
    goal: Goal | None
    options: PlanningOptions
    checker: MotionChecker | None

    def touches(self, positions: FloatArray) -> Sequence[Touch]:
        """What is too near at group positions, nearest first."""
        if self.checker is None:
            return self.scene.touches(self.space.whole(positions), self.options.padding)
        return self.checker.touches(positions)

    def is_free(self, positions: FloatArray) -> bool:
        """Whether nothing is too near at group positions; much faster than `touches`."""
        if self.checker is None:
            return not self.touches(positions)
        return self.checker.state_free(positions)

    def joints(self, positions: FloatArray) -> dict[str, float]:
        """Every joint of the robot by name, at positions of the group."""
        whole = self.space.whole(np.asarray(positions, dtype=float))
        names = self.space.robot.description.joint_names
        return dict(zip(names, map(float, whole), strict=True))


def nearest_state(request: StageRequest, goal: LinkGoal, nearest: NearestPose) -> NearestState:
    """A nearest pose with the robot's joints, the link, the target, and what is missed."""
    target = goal.pose.as_vector() if isinstance(goal, PoseGoal) else goal.position
    return NearestState(
        shows="nearest pose",
        joint_positions=request.joints(nearest.positions),
        link=goal.link,
        target=tuple(map(float, target)),
        pose=tuple(map(float, nearest.pose.as_vector())),
        position_error=nearest.shift,
        orientation_error=nearest.turn,
    )
