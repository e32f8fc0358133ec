"""Follows belts and turntables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ClassVar

from harness.cell.cell import Cell
from harness.cell.grasp_choice import ChosenApproach
from harness.cell.step import Step
from harness.core.spatial import SE3
from harness.plugins.belts.moving_frames import execute_motion
from harness.plugins.belts.pick_in_motion import pick_in_motion
from harness.plugins.belts.place_in_motion import place_in_motion
from harness.steps._tracker import Tracker
from harness.steps.grasp import Grasp
from harness.steps.move_relative import MoveRelative


class BeltTracker(Tracker):
    """Follow an object, or a place, on a belt or a turntable, whose motion is known."""

    name: ClassVar[str] = "belt"

    def execute(self, spec: Step, cell: Cell) -> None:
        execute_motion(spec, cell)

    def pick(
        self, grasp: Grasp, lift: MoveRelative, choose: Callable[[], ChosenApproach], cell: Cell
    ) -> None:
        pick_in_motion(grasp, lift, choose, cell)

    def place(
        self, name: str, targets: Sequence[SE3], retreat: float, group: str, cell: Cell
    ) -> None:
        place_in_motion(name, targets, retreat, group, cell)
