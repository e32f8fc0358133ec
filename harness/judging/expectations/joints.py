"""joints: joints stand at positions."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from harness.cell.scope import At
from harness.judging.expectation import Mechanisms, Predicate
from harness.judging.joints import POSITION_ERROR, check_tolerance, near
from harness.judging.margins import MarginSignal
from harness.judging.window import Window
from harness.language.base import JointValue, Name


class Joints(Predicate):
    """Joints stand at positions."""

    sentence = "joints are at {positions}"
    quantities = (POSITION_ERROR,)

    positions: Annotated[dict[Name, JointValue], Field(min_length=1)] = Field(
        description="The position of each joint by its name; the others stand anywhere."
    )
    tolerance: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.01,
        description="The tolerance of each joint; by default 0.01 rad, and 2 mm where it slides.",
    )

    def check(self, at: At) -> None:
        for name in self.positions:
            at.scope.check_joint(name, at.key("positions", name))
        is_given = "tolerance" in self.model_fields_set
        check_tolerance(at, "positions", self.positions, self.tolerance, is_given)

    def joint_units(self, mechanisms: Mechanisms) -> frozenset[str]:
        return mechanisms.units_of(self.positions)

    def looks_back(self) -> float:
        return 0.0

    def signal(self, window: Window) -> MarginSignal:
        """The worst joint's distance from its position [rad or m]."""
        is_given = "tolerance" in self.model_fields_set
        return near(window, self.positions, self.tolerance, is_given)
