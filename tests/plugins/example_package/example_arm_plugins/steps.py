"""A step that shakes the arm's last joint."""

from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.language.base import Angle
from harness.language.step import Step


class Wave(Step):
    """Turn the arm's last joint by an angle and back."""

    verb: ClassVar[str] = "wave"
    short: ClassVar[str] = "by"

    by: Angle = Field(description="The last joint turns by this angle [rad].")

    def summary(self) -> str:
        """The angle."""
        return f"by {self.by:g} rad"

    def execute(self, cell: Cell) -> None:
        """Move there and back."""
        group, start = group_of(cell, self.group), cell.planning_start()
        indices = list(cell.description.group_indices(group))
        home = start[indices].copy()
        away = home.copy()
        away[-1] += self.by
        for goal in (away, home):
            start = cell.planning_start()
            plan = cell.planner.plan_joint_motion(group, start, goal, cell.current.options)
            cell.carry_out(plan)
