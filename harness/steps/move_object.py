"""move_object: an object stands somewhere else."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.base import Name
from harness.language.poses import Pose


class MoveObject(Step):
    """Put an object somewhere else, at rest."""

    verb: ClassVar[str] = "move_object"
    plans: ClassVar[bool] = False
    synonyms = ("teleport", "set_model_pose", "set_entity_pose")
    moves_objects: ClassVar[bool] = True

    object: Name = Field(description="The name of the object.")
    pose: Pose = Field(description="The object's new pose.")

    def summary(self) -> str:
        return self.object

    def check(self, at: At) -> None:
        at.scope.check_present(self.object, at.key("object"))
        at.scope.check_no_fixture(self.object, at.key("object"))
        at.check_pose(self.pose, "pose")

    def execute(self, cell: Cell) -> None:
        cell.move_in_scene(self.object, cell.world_pose(self.pose))
