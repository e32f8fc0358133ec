"""Damped least squares with restarts as a solver."""

from __future__ import annotations

from typing import ClassVar, cast

from harness.planning.ik.numeric import pitch_of, solve_numeric
from harness.planning.ik.task import PITCH_JOINTS, WHOLE_POSE_JOINTS
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.kinematics import IkRequest, IkResult, IkSolver


class NumericSolver(IkSolver):
    """Damped least squares of any chain, with seeded restarts."""

    name: ClassVar[str] = "numeric"

    def solve(self, request: IkRequest) -> IkResult:
        """Solve for the goal; an arm of few joints for the part of a pose that it can choose."""
        goal, space = request.goal, cast("GroupSpace", request.space)
        enough = request.enough
        found = solve_numeric(space, goal, request.seed_positions, request.seed, enough=enough)
        if isinstance(goal, PoseGoal) and not found and space.dof < WHOLE_POSE_JOINTS:
            part = reduced(space.dof, goal)
            found = solve_numeric(space, part, request.seed_positions, request.seed, enough=enough)
        return IkResult(tuple(found))


def reduced(dof: int, goal: PoseGoal) -> PositionGoal:
    """The part of a pose that an arm with fewer than six joints can choose."""
    pitch = pitch_of(goal.pose.rotation) if dof >= PITCH_JOINTS else None
    return PositionGoal(goal.link, goal.pose.translation, pitch)
