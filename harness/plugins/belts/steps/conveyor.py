"""conveyor: the surface of a static object starts, changes its speed, or stops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.core.surface_motion import SurfaceMotion
from harness.language.base import AngularVelocity, Duration, Name
from harness.language.world import SurfaceVelocity, surface_motion

DEFAULT_RAMP = 0.2
"""[s]: at 0.5 m/s, boxes with a friction of 0.26 or more follow without slipping."""


@dataclass(frozen=True)
class SurfaceChange(Detail):
    """The surface whose motion a step changed, and how it moved before and moves after."""

    surface: str
    before: SurfaceMotion
    after: SurfaceMotion


class Conveyor(Step):
    """Start a belt or a turntable, change its speed, or stop it.

    A static object with `surface_velocity` or `surface_rotation` is one: its surface moves and
    carries what lies on it by friction, while the object stays in its place. The motion changes
    evenly during `ramp`, and then goes on until another `conveyor` step. The arm stands during the
    ramp.
    """

    verb: ClassVar[str] = "conveyor"
    plans: ClassVar[bool] = False
    synonyms = ("belt", "turntable")
    simulated_only = (
        "a belt of the real cell is not driven by a scenario",
        "leave the step out, and let the cell's own controller drive the belt",
    )
    some_of = ("velocity", "rotation")
    keeps_arm_still: ClassVar[bool] = True
    results = (SurfaceChange,)

    object: Name = Field(description="The name of the belt or turntable.")
    velocity: SurfaceVelocity | None = Field(
        default=None,
        description="The velocity of the surface [m/s]: a number along the object's x axis, or a"
        " vector in the object's axes; 0 stops it.",
    )
    rotation: AngularVelocity | None = Field(
        default=None,
        description="The rate at which the surface turns about the object's z axis [rad/s], as that"
        " of a turntable; 0 stops it.",
    )
    ramp: Duration = Field(
        default=DEFAULT_RAMP, description="The motion changes evenly over this duration [s]."
    )

    def summary(self) -> str:
        return f"{self.object} {self._motion}"

    @property
    def _motion(self) -> SurfaceMotion:
        return surface_motion(self.velocity, self.rotation)

    def check(self, at: At) -> None:
        scope, loc = at.scope, at.key("object")
        scope.check_present(self.object, loc)
        scope.check_object(self.object, loc, simulated=True)
        obj = scope.objects.get(self.object)
        if obj is not None and obj.surface_motion is None:
            belts = [each.name for each in scope.objects.values() if each.surface_motion]
            known = f", or name one of {', '.join(belts)}" if belts else ""
            keys = "`surface_velocity: 0`"
            scope.problems.add(
                loc,
                f"the surface of '{self.object}' does not move"
                + ("" if obj.is_static else ": it is not static"),
                f"add {keys if obj.is_static else f'`static: true` and {keys}'} to"
                f" '{self.object}'{known}",
            )
        scope.take_time(self.ramp, at.key("ramp"))

    def execute(self, cell: Cell) -> None:
        """Change the motion of the surface evenly; simulated time passes."""
        before = cell.simulator.surface_motion(self.object)
        cell.simulator.drive_surface(self.object, self._motion, self.ramp)
        cell.report(SurfaceChange(self.object, before, self._motion))
