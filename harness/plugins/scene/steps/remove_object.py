"""remove_object: objects disappear."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.base import Name


class RemoveObject(Step):
    """Remove one or several objects."""

    short = "objects"
    short_is_list = True

    verb: ClassVar[str] = "remove_object"
    plans: ClassVar[bool] = False
    synonyms = ("delete", "remove", "despawn", "delete_object")
    moves_objects: ClassVar[bool] = True

    objects: Annotated[tuple[Name, ...], Field(min_length=1)] = Field(
        description="The names of the objects."
    )

    def summary(self) -> str:
        return ", ".join(self.objects)

    def check(self, at: At) -> None:
        for index, name in enumerate(self.objects):
            at.scope.check_present(name, at.key("objects", index))
            at.scope.check_no_fixture(name, at.key("objects", index))
            at.scope.present.pop(name, None)
            at.scope.added.pop(name, None)

    def execute(self, cell: Cell) -> None:
        """Take the objects out of the planning scene and the physics."""
        for name in self.objects:
            cell.remove_from_scene(name)
