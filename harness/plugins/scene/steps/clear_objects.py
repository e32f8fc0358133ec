"""clear_objects: what steps added is removed."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.base import Flag


class ClearObjects(Step):
    """Remove the objects that steps added; with `world: true` the world's objects too."""

    verb: ClassVar[str] = "clear_objects"
    plans: ClassVar[bool] = False
    moves_objects: ClassVar[bool] = True

    world: Flag = Field(default=False, description="The world's objects are removed too.")

    def summary(self) -> str:
        return "with the world's" if self.world else ""

    def check(self, at: At) -> None:
        scope = at.scope
        for name in list(scope.present) if self.world else list(scope.added):
            if name not in scope.attached:
                scope.present.pop(name, None)
                scope.added.pop(name, None)

    def execute(self, cell: Cell) -> None:
        """Remove what steps added, and with `world` all; what is attached stays, as in MoveIt."""
        attached = cell.scene.attached()
        there = [name for name, presence in cell.presence.items() if presence.is_there]
        for name in there:
            if name not in attached and (self.world or cell.presence[name].added_by_step):
                cell.remove_from_scene(name)
