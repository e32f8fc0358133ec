"""add_object: objects appear."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.errors import StepFailed
from harness.language.files.source import Loc
from harness.language.world import ObjectSpec


class AddObject(Step):
    """Add one or several objects."""

    short = "objects"
    short_is_list = True

    verb: ClassVar[str] = "add_object"
    plans: ClassVar[bool] = False
    synonyms = ("spawn", "add", "create_object", "add_collision_object")
    moves_objects: ClassVar[bool] = True

    objects: Annotated[tuple[ObjectSpec, ...], Field(min_length=1)] = Field(
        description="One or several objects; a dynamic one falls from where it appears."
    )

    def summary(self) -> str:
        return ", ".join(spec.name for spec in self.objects)

    def new_objects(self) -> Iterator[tuple[Loc, ObjectSpec]]:
        for index, spec in enumerate(self.objects):
            yield ("objects", index), spec

    def check(self, at: At) -> None:
        for index, spec in enumerate(self.objects):
            at.check_pose(spec.pose, "objects", index, "pose")
            if spec.name in at.scope.present:
                at.scope.problems.add(
                    at.key("objects", index, "name"), f"'{spec.name}' is in the scene already"
                )
            at.scope.present[spec.name] = None
            at.scope.added[spec.name] = None

    def execute(self, cell: Cell) -> None:
        """Add the objects to the planning scene, the physics, or both."""
        for spec in self.objects:
            presence = cell.presence.get(spec.name)
            if presence is not None and presence.is_there:
                raise StepFailed("INVALID_OBJECT_NAME", f"'{spec.name}' is in the scene already")
            obj = presence.obj if presence is not None else cell.later_objects[spec.name]
            cell.add_to_scene(obj, cell.world_pose(spec.pose))
