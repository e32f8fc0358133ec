"""lin: Pilz's straight line."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

from harness.cell.cell import Cell
from harness.cell.goal_checks import check_goal
from harness.cell.goals import group_of, link_limits, resolve_goal
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.goals import LineFields
from harness.ports.motions import LinearMotion


class Lin(LineFields, Step):
    """Pilz LIN: the link moves on a straight line."""

    verb: ClassVar[str] = "lin"
    synonyms = ("movel", "move_l", "move_linear", "line")
    moves_arm: ClassVar[bool] = True

    def check(self, at: At) -> None:
        check_goal(self, self.group, at)

    def execute(self, cell: Cell) -> None:
        cell.sync_scene()
        group = group_of(cell, self.group)
        goal = resolve_goal(self, group, cell)
        options = replace(cell.current.options, cartesian_limits=link_limits(self.cartesian_limits))
        cell.move(group, LinearMotion(goal), options)
