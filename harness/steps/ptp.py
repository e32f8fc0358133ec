"""ptp: Pilz's synchronised joint motion."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goal_checks import check_goal
from harness.cell.goals import group_of, resolve_goal
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.errors import PlanningFailed
from harness.language.base import PositiveDuration
from harness.language.goals import GoalFields
from harness.ports.goals import JointGoal
from harness.ports.motions import FreeMotion, JointMotion


class Ptp(GoalFields, Step):
    """Pilz PTP: all joints move together, straight in joint space."""

    verb: ClassVar[str] = "ptp"
    moves_arm: ClassVar[bool] = True

    duration: PositiveDuration | None = Field(
        default=None,
        description="The motion takes exactly this time, as time_from_start of a JointTrajectory "
        "point [s].",
    )

    def check(self, at: At) -> None:
        check_goal(self, self.group, at)
        if self.duration is not None:
            at.scope.take_time(self.duration, at.key("duration"))
            if not (self.joints or self.named_target):
                at.scope.problems.add(
                    at.key("duration"), "`duration` goes with `joints` or a named state"
                )

    def execute(self, cell: Cell) -> None:
        cell.sync_scene()
        group = group_of(cell, self.group)
        goal = resolve_goal(self, group, cell)
        if isinstance(goal, JointGoal):
            positions = goal.positions
        else:
            cell.planner.check_goal(cell.motion(group, FreeMotion(goal)))
            start, seed = cell.planning_start(), cell.current.options.seed
            solutions = cell.kinematics.solve(group, goal, start, seed)
            if not solutions:
                raise PlanningFailed("NO_IK_SOLUTION", "no joint positions reach the goal")
            positions = solutions[0]
        cell.move(group, JointMotion(positions, self.duration))
