"""move_to: plan a collision-free motion, then follow it."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goal_checks import check_goal
from harness.cell.goals import group_of, path_constraints, resolve_goal
from harness.cell.scope import At
from harness.language.goals import GOAL_KEYS, GoalFields
from harness.language.planning import PathConstraintsSpec
from harness.language.step import Step
from harness.ports.goals import AnyGoal
from harness.ports.motions import FreeMotion


class MoveTo(GoalFields, Step):
    """Plan a collision-free motion to a goal, then execute it.

    Where joint positions can be chosen (branches of a pose, several goals, a region), those are
    taken that the arm reaches with the least motion.
    """

    verb: ClassVar[str] = "move_to"
    synonyms = ("move", "goto", "go_to", "movej", "set_named_target", "set_pose_target")
    moves_arm: ClassVar[bool] = True
    goal_keys: ClassVar[tuple[str, ...]] = (*GOAL_KEYS, "any_of")

    any_of: Annotated[tuple[GoalFields, ...], Field(min_length=1, max_length=100)] | None = Field(
        default=None,
        description="The motion goes to the one of these goals that is cheapest to reach.",
    )
    path_constraints: PathConstraintsSpec | None = Field(
        default=None, description="Constraints that hold at every sample of the motion."
    )

    def summary(self) -> str:
        if self.any_of is not None:
            return "any of " + ", ".join(goal.summary() for goal in self.any_of)
        return super().summary()

    def check(self, at: At) -> None:
        check_goal(self, self.group, at)
        for index, goal in enumerate(self.any_of or ()):
            check_goal(goal, self.group, At(at.scope, at.key("any_of", index)))
        if self.path_constraints is not None:
            _check_constraints(self.path_constraints, self.group, at)

    def execute(self, cell: Cell) -> None:
        """Plan from where the arm stands to the goal, time the path, track it."""
        cell.sync_scene()
        group = group_of(cell, self.group)
        goals = tuple(resolve_goal(goal, group, cell) for goal in self.any_of or (self,))
        goal = goals[0] if self.any_of is None else AnyGoal(goals)
        constraints = None
        if self.path_constraints is not None:
            constraints = path_constraints(self.path_constraints, cell)
        cell.move(group, FreeMotion(goal, constraints))


def _check_constraints(constraints: PathConstraintsSpec, group_name: str | None, at: At) -> None:
    scope = at.scope
    band, box = constraints.orientation, constraints.position
    if band is not None:
        scope.check_link_or_held(band.link, at.key("path_constraints", "orientation", "link"))
        at.check_pose(band.pose, "path_constraints", "orientation", "pose")
    if box is not None:
        scope.check_link_or_held(box.link, at.key("path_constraints", "position", "link"))
        frame = at.key("path_constraints", "position", "center", "frame")
        scope.check_frame(box.center.frame, frame)
    group = scope.check_group(group_name, at.key("group"))
    for name in constraints.joints or {}:
        scope.check_joint(name, at.key("path_constraints", "joints", name), group)
