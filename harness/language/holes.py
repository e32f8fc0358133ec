"""Holes in boxes as files describe them."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field, model_validator

from harness.language.base import Count, Length, PositiveLength, SpecModel

RING = math.sqrt(2) - 1 + 0.01
"""Thickness of the turned boxes around a round hole, as a share of its radius: they cover the
corners of the square around it, with a hundredth to spare."""


class HoleSpec(SpecModel):
    """A hole from the upper face of a box, along the box's z axis.

    A rectangular hole is exact. A round one is a regular polygon whose sides touch the circle: a
    peg has the stated clearance at the middle of each side, and r * (1 / cos(180 deg / sides) - 1)
    more in the corners, 0.5 % of the radius with 32 sides.
    """

    one_of = ("diameter", "size")

    diameter: PositiveLength | None = Field(
        default=None, description="The diameter of a round hole [m]."
    )
    size: tuple[PositiveLength, PositiveLength] | None = Field(
        default=None, description="The width of a rectangular hole along x and y [m]."
    )
    at: tuple[Length, Length] = Field(
        default=(0.0, 0.0), description="The axis of the hole, from the middle of the box, x and y."
    )
    depth: PositiveLength | None = Field(
        default=None, description="The depth of the hole [m]; by default it goes through."
    )
    sides: Annotated[Count, Field(ge=8, le=128, multiple_of=4)] = Field(
        default=32, description="The number of sides of the polygon that a round hole is."
    )

    @property
    def widths(self) -> tuple[float, float]:
        """The full width along x and y [m]."""
        if self.diameter is not None:
            return self.diameter, self.diameter
        assert self.size is not None  # the model has one of them
        return self.size

    def refuse_outside(self, box: tuple[float, float, float]) -> None:
        """Check that a box has walls around the hole.

        Raises:
            ValueError: The hole, with the ring of a round one, is not inside the box.
        """
        ring = 1 + RING if self.diameter is not None else 1.0
        ring /= math.cos(math.pi / self.sides) if self.diameter is not None else 1.0
        for axis in range(2):
            needed = abs(self.at[axis]) + ring * self.widths[axis] / 2
            if needed >= box[axis] / 2:
                around = ", 0.43 of the radius around a round hole" if ring > 1 else ""
                raise ValueError(
                    f"the hole leaves no wall along {'xy'[axis]}: the box needs a `size` of more"
                    f" than {2e3 * needed:.4g} mm there{around}"
                )

    @model_validator(mode="after")
    def _sides_of_a_circle(self) -> HoleSpec:
        if self.size is not None and "sides" in self.model_fields_set:
            raise ValueError("a rectangular hole has four sides: leave out `sides`")
        return self
