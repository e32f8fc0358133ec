"""attach_object: fix an object to a link in the planning scene, as AttachedCollisionObject."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from pydantic import Discriminator, Field, Tag

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.base import Name, kind_of
from harness.language.files.source import Loc
from harness.language.world import ObjectSpec


class AttachObject(Step):
    """Fix an object to a link, in the planning scene alone."""

    short = "object"

    verb: ClassVar[str] = "attach_object"
    plans: ClassVar[bool] = False

    object: Annotated[
        Annotated[Name, Tag("one")] | Annotated[ObjectSpec, Tag("many")], Discriminator(kind_of)
    ] = Field(description="The name of an object in the scene, or a new object.")
    link: Name | None = Field(
        default=None, description="The link that carries the object; the default is the TCP link."
    )
    touch_links: tuple[Name, ...] | None = Field(
        default=None,
        description="Links that may touch the object; the default is the gripper's links.",
    )
    represents: Name | None = Field(
        default=None,
        description="The physical object that this one stands for; it leaves the planning scene "
        "until this one is detached.",
    )

    @property
    def object_name(self) -> str:
        """The name of the object, whether it is in the scene or new."""
        return self.object if isinstance(self.object, str) else self.object.name

    def summary(self) -> str:
        name = self.object_name
        return f"{name} for {self.represents}" if self.represents else name

    def new_objects(self) -> Iterator[tuple[Loc, ObjectSpec]]:
        if isinstance(self.object, ObjectSpec):
            yield ("object",), self.object

    def check(self, at: At) -> None:
        scope, name = at.scope, self.object_name
        if isinstance(self.object, str):
            scope.check_present(name, at.key("object"))
        else:
            at.check_pose(self.object.pose, "object", "pose")
            scope.present[name] = None
            scope.added[name] = None
        scope.check_link(self.link, at.key("link"))
        for index, link in enumerate(self.touch_links or ()):
            scope.check_link(link, at.key("touch_links", index))
        if self.represents is not None:
            scope.check_object(self.represents, at.key("represents"), simulated=True)
        scope.attached[name] = None

    def execute(self, cell: Cell) -> None:
        """Fix the object to the link; a new object is added to the scene first."""
        cell.sync_scene()
        name = self.object_name
        if isinstance(self.object, ObjectSpec):
            cell.add_to_scene(cell.later_objects[name], cell.world_pose(self.object.pose))
        link = self.link or cell.description.tcp_link
        touch_links = self.touch_links
        if touch_links is None:
            hand = cell.description.gripper
            touch_links = hand.links if hand else ()
        cell.attach(name, link, touch_links, self.represents)
