"""What a robot's base stands on, as files describe it: rails of a gantry, and a pedestal."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from harness.language.base import (
    Force,
    Length,
    LinearAcceleration,
    LinearVelocity,
    Name,
    Number,
    PositiveLength,
    SpecModel,
    kind_of,
)
from harness.language.plugin_field import KeyModel

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


class RailSpec(SpecModel):
    """A linear axis that carries the arm; it is the first joint of the arm's group."""

    name: Name = Field(default="rail", description="The name of its joint.")
    axis: Annotated[
        Annotated[str, Tag("one")] | Annotated[tuple[Number, Number, Number], Tag("many")],
        Discriminator(kind_of),
    ] = Field(description="The direction at the base: `x`, `y`, `z`, or three numbers.")
    range: tuple[Length, Length] = Field(description="The limits of its position [m].")
    max_velocity: Annotated[LinearVelocity, Field(gt=0)] = Field(
        default=1.0, description="The largest speed [m/s]."
    )
    max_acceleration: Annotated[LinearAcceleration, Field(gt=0)] = Field(
        default=2.0, description="The largest acceleration [m/s**2]."
    )
    max_effort: Annotated[Force, Field(gt=0)] = Field(
        default=2000.0, description="The largest force of its drive [N]."
    )

    @field_validator("axis")
    @classmethod
    def _is_an_axis(cls, value: str | tuple[float, float, float]) -> object:
        if isinstance(value, str):
            if value not in AXES:
                raise ValueError("an axis is `x`, `y`, `z`, or three numbers")
        elif math.hypot(*value) < 1e-9:
            raise ValueError("an axis has some length; this one is (0, 0, 0)")
        return value

    @model_validator(mode="after")
    def _ordered(self) -> RailSpec:
        if self.range[0] >= self.range[1]:
            raise ValueError("the lower limit of the range is not below the upper one")
        return self

    @property
    def direction(self) -> tuple[float, float, float]:
        """Unit direction of the axis at the base."""
        given = AXES[self.axis] if isinstance(self.axis, str) else self.axis
        length = math.hypot(*given)
        return given[0] / length, given[1] / length, given[2] / length


class MountSpec(KeyModel):
    """What stands between the world and the arm: a pedestal, then rails one on the other."""

    key: ClassVar[str] = "mount"
    some_of = ("rail", "pedestal")

    rail: (
        Annotated[
            Annotated[RailSpec, Tag("one")]
            | Annotated[tuple[RailSpec, ...], Field(min_length=1, max_length=3), Tag("many")],
            Discriminator(lambda value: "many" if isinstance(value, list | tuple) else "one"),
        ]
        | None
    ) = Field(
        default=None,
        description="A linear axis, or up to three of a gantry, each carrying the next.",
    )
    pedestal: tuple[PositiveLength, PositiveLength, PositiveLength] | None = Field(
        default=None,
        description="The full size of a box under the base along x, y, z [m]: `base` is its foot.",
    )

    @property
    def rails(self) -> tuple[RailSpec, ...]:
        """The rails, the one that stands in the world first."""
        if self.rail is None:
            return ()
        return self.rail if isinstance(self.rail, tuple) else (self.rail,)
