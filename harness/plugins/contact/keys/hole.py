"""The key `hole` of a box, which is composed of boxes around the hole, so that nothing fills it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.core.world import Hole
from harness.language.base import Count, Length, PositiveLength
from harness.language.world import HoleKey

Rectangle = tuple[float, float, float, float]  # centre x, y and full size along x, y [m]

RING = math.sqrt(2) - 1 + 0.01
"""Thickness of the turned boxes around a round hole, as a share of its radius: they cover the
corners of the square around it, with a hundredth to spare."""


class HoleSpec(HoleKey):
    """A hole from the upper face of a box, along the box's z axis.

    A rectangular hole is exact. A round one is a regular polygon whose sides touch the circle: a
    peg has the stated clearance at the middle of each side, and r * (1 / cos(180 deg / sides) - 1)
    more in the corners, 0.5 % of the radius with 32 sides.
    """

    key: ClassVar[str] = "hole"
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

    @property
    def is_round(self) -> bool:
        """Whether it has a diameter."""
        return self.diameter is not None

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

    def bored(self, whole: Shape) -> tuple[tuple[Shape, ...], Hole]:
        """The boxes of a box with a hole from its upper face, and the hole.

        Four boxes surround a rectangle; around a circle turned boxes, whose faces touch it, cut the
        corners of its square to a regular polygon. A floor closes a hole that does not go through.
        """
        assert isinstance(whole.geometry, Box)
        width, length, height = whole.geometry.size
        depth = min(self.depth or height, height)
        (x, y), (across, along) = self.at, self.widths
        middle = (height - depth) / 2

        def part(rectangle: Rectangle, turn: float = 0.0) -> Shape:
            pose = whole.pose @ SE3.from_xyz_rpy((*rectangle[:2], middle), (0, 0, turn))
            return replace(whole, geometry=Box((*rectangle[2:], depth)), pose=pose)

        left, right = x - across / 2 + width / 2, width / 2 - x - across / 2
        back, front = y - along / 2 + length / 2, length / 2 - y - along / 2
        parts = [
            part(((left - width) / 2, 0.0, left, length)),
            part(((width - right) / 2, 0.0, right, length)),
            part((x, (back - length) / 2, across, back)),
            part((x, (length - front) / 2, across, front)),
        ]
        if self.diameter is not None:
            radius, thick = self.diameter / 2, RING * self.diameter / 2
            side = 2 * (radius + thick) * math.tan(math.pi / self.sides)
            for number in range(self.sides):
                if number % (self.sides // 4):  # the four others are faces of the boxes around
                    angle = 2 * math.pi * number / self.sides
                    out = radius + thick / 2
                    place = (x + out * math.cos(angle), y + out * math.sin(angle), thick, side)
                    parts.append(part(place, angle))
        if depth < height:
            floor = whole.pose @ SE3.from_xyz_rpy((0.0, 0.0, -depth / 2))
            parts.append(replace(whole, geometry=Box((width, length, height - depth)), pose=floor))
        opening = whole.pose @ SE3.from_xyz_rpy((x, y, height / 2))
        pose = tuple(map(float, opening.as_vector()))
        return tuple(parts), Hole(pose, (across, along), depth, self.diameter is not None)
