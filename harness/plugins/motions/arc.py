"""Arcs of a file: their keys, and the point that makes one."""

from __future__ import annotations

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import world_point
from harness.cell.scope import At
from harness.language.goals import LineFields
from harness.language.poses import Position
from harness.ports.motions import ArcPoint


class ArcFields(LineFields):
    """An arc of the link to a goal, through `interim` or about `center`."""

    one_of = ("interim", "center")

    interim: Position | None = Field(
        default=None,
        description="The arc passes through this point; it may be any but a full circle.",
    )
    center: Position | None = Field(
        default=None,
        description="The arc is the shorter one about this centre, less than half a circle.",
    )


def check_arc(arc: ArcFields, at: At) -> None:
    """Report frames that an arc's interim point or centre does not have."""
    for key in ("interim", "center"):
        point = getattr(arc, key)
        if point is not None:
            at.scope.check_frame(point.frame, at.key(key, "frame"))


def arc_point(arc: ArcFields, cell: Cell) -> ArcPoint:
    """The point that makes an arc of a start and a goal, in the world."""
    if arc.interim is not None:
        return ArcPoint("interim", world_point(arc.interim, cell))
    if arc.center is not None:
        return ArcPoint("center", world_point(arc.center, cell))
    raise ValueError("the model has an interim point or a centre")
