"""circ: Pilz's arc."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

from harness.cell.cell import Cell
from harness.cell.goal_checks import check_goal
from harness.cell.goals import group_of, link_limits, resolve_goal
from harness.cell.scope import At
from harness.cell.step import Step
from harness.plugins.motions.arc import ArcFields, arc_point, check_arc
from harness.ports.motions import CircularMotion


class Circ(ArcFields, Step):
    """Pilz CIRC: the link moves on an arc, through `interim` or about `center`."""

    verb: ClassVar[str] = "circ"
    synonyms = ("movec", "arc")
    is_arc: ClassVar[bool] = True
    moves_arm: ClassVar[bool] = True

    def check(self, at: At) -> None:
        check_goal(self, self.group, at)
        check_arc(self, at)

    def execute(self, cell: Cell) -> None:
        """Move the link on an arc to the goal, turning at an even rate."""
        cell.sync_scene()
        group = group_of(cell, self.group)
        goal, point = resolve_goal(self, group, cell), arc_point(self, cell)
        options = replace(cell.current.options, cartesian_limits=link_limits(self.cartesian_limits))
        cell.move(group, CircularMotion(goal, point), options)
