"""A step that shakes the arm's last joint."""

from typing import ClassVar

from pydantic import Field

from harness.steps import Angle, Cell, JointMotion, Step, group_of


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
            cell.move(group, JointMotion(goal))
