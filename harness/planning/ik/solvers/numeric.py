"""Damped least squares with restarts as a solver."""

from __future__ import annotations

from functools import partial
from typing import ClassVar, cast

from harness.core.spatial import pitch_of
from harness.planning.ik.numeric import TiltGoal, solve_numeric
from harness.planning.ik.task import PITCH_JOINTS, TILT_JOINTS, WHOLE_POSE_JOINTS
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.kinematics import IkRequest, IkResult, IkSolver


class NumericSolver(IkSolver):
    """Damped least squares of any chain, from the seed and from near the goal."""

    name: ClassVar[str] = "numeric"

    def solve(self, request: IkRequest) -> IkResult:
        """Solve for the goal; an arm of few joints for the part of a pose that it can choose."""
        goal, space = request.goal, cast("GroupSpace", request.space)
        search = partial(
            solve_numeric, seed_positions=request.seed_positions, enough=request.enough
        )
        if isinstance(goal, PoseGoal) and space.dof == TILT_JOINTS:
            part = TiltGoal.of(goal.link, goal.pose)
            return IkResult(tuple(search(space, goal, part=part)))
        found = search(space, goal)
        if isinstance(goal, PoseGoal) and not found and space.dof < WHOLE_POSE_JOINTS:
            pitch = pitch_of(goal.pose.rotation) if space.dof >= PITCH_JOINTS else None
            point = PositionGoal(goal.link, goal.pose.translation, pitch)
            found = search(space, point)
        return IkResult(tuple(found))
