"""Damped least squares with restarts as a solver."""

from __future__ import annotations

from functools import partial
from typing import ClassVar, cast

from harness.planning.ik.numeric import TiltGoal, solve_numeric
from harness.planning.ik.task import part_of_pose
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal
from harness.ports.kinematics import IkRequest, IkResult, IkSolver


class NumericSolver(IkSolver):
    """Damped least squares of any chain, from the seed and from near the goal."""

    name: ClassVar[str] = "numeric"
    title: ClassVar[str] = "numeric, with restarts"

    def solve(self, request: IkRequest) -> IkResult:
        """Solve for the goal; for the part of a pose that the group can hold."""
        goal, space = request.goal, cast("GroupSpace", request.space)
        search = partial(
            solve_numeric, seed_positions=request.seed_positions, enough=request.enough
        )
        part = goal
        if isinstance(goal, PoseGoal) and not space.task_space.holds_pose:
            part = part_of_pose(space.task_space, goal.link, goal.pose)
        if isinstance(part, TiltGoal):
            return IkResult(tuple(search(space, goal, part=part)))
        found = search(space, goal)
        if not found and part is not goal:
            found = search(space, part)
        return IkResult(tuple(found))
