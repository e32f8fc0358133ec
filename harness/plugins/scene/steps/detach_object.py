"""detach_object: release an attached object in the planning scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.language.base import Name


@dataclass(frozen=True)
class Detached(Detail):
    """The object that is attached no more, by name."""

    detached: str


class DetachObject(Step):
    """Detach an object from its link, in the planning scene alone."""

    short = "object"

    verb: ClassVar[str] = "detach_object"
    plans: ClassVar[bool] = False
    detaches_object: ClassVar[bool] = True
    results = (Detached,)

    object: Name = Field(description="The name of the object.")

    def summary(self) -> str:
        return self.object

    def check(self, at: At) -> None:
        at.scope.check_object(self.object, at.key("object"))
        if self.object in at.scope.objects and self.object not in at.scope.attached:
            at.scope.problems.add(at.key("object"), f"'{self.object}' is not attached at this step")
        at.scope.attached.pop(self.object, None)

    def execute(self, cell: Cell) -> None:
        """Detach the object; it stays in the planning scene where it is."""
        cell.detach(self.object)
        cell.report(Detached(self.object))
