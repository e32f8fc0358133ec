"""Hinges and slides as files describe them: of doors, drawers, lids, valves and buttons."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BeforeValidator, Field, field_validator, model_validator

from harness.language.base import Angle, Force, Length, Number, SpecModel, Torque, Xyz, quantity

NOT_NEGATIVE = Field(ge=0)


class _Motion(SpecModel):
    """What hinges and slides have in common."""

    axis: tuple[Number, Number, Number] = Field(
        description="The direction of the axis in the object's frame; its length does not matter."
    )

    @field_validator("axis")
    @classmethod
    def _has_length(cls, value: tuple[float, float, float]) -> tuple[float, float, float]:
        if math.hypot(*value) < 1e-9:
            raise ValueError("an axis has some length; this one is (0, 0, 0)")
        return value


class HingeSpec(_Motion):
    """A part that turns about an axis, as a door, a lid or a valve."""

    at: Xyz = Field(
        default=(0.0, 0.0, 0.0), description="A point on the axis, in the object's frame [m]."
    )
    range: tuple[Angle, Angle] = Field(description="The limits of its position [rad].")
    start: Angle = Field(default=0.0, description="The position at the start [rad].")
    friction: Annotated[Torque, NOT_NEGATIVE] = Field(
        default=0.05, description="The friction torque [N m]."
    )
    damping: Annotated[float, BeforeValidator(quantity("N*m*s/rad")), NOT_NEGATIVE] = Field(
        default=0.02, description="The resistance for each velocity [N m s/rad]."
    )
    stiffness: Annotated[float, BeforeValidator(quantity("N*m/rad")), NOT_NEGATIVE] = Field(
        default=0.0, description="The stiffness of a spring [N m/rad]."
    )
    rest: Angle = Field(
        default=0.0, description="The position at which the spring is relaxed [rad]."
    )

    @model_validator(mode="after")
    def _starts_within_its_range(self) -> HingeSpec:
        _check_range(self.range, self.start, "rad")
        if max(map(abs, self.range)) > math.pi + 1e-9:
            raise ValueError("a hinge turns by at most half a turn from its closed position")
        return self


class SlideSpec(_Motion):
    """A part that moves along an axis, as a drawer or a button."""

    range: tuple[Length, Length] = Field(description="The limits of its position [m].")
    start: Length = Field(default=0.0, description="The position at the start [m].")
    friction: Annotated[Force, NOT_NEGATIVE] = Field(
        default=0.5, description="The friction force [N]."
    )
    damping: Annotated[float, BeforeValidator(quantity("N*s/m")), NOT_NEGATIVE] = Field(
        default=1.0, description="The resistance for each velocity [N s/m]."
    )
    stiffness: Annotated[float, BeforeValidator(quantity("N/m")), NOT_NEGATIVE] = Field(
        default=0.0, description="The stiffness of a spring [N/m]."
    )
    rest: Length = Field(
        default=0.0, description="The position at which the spring is relaxed [m]."
    )

    @model_validator(mode="after")
    def _starts_within_its_range(self) -> SlideSpec:
        _check_range(self.range, self.start, "m")
        return self


def _check_range(limits: tuple[float, float], start: float, unit: str) -> None:
    lower, upper = limits
    if lower >= upper:
        raise ValueError(
            f"the lower limit of the range is not below the upper one: {lower:g}, {upper:g} {unit}"
        )
    if not lower <= start <= upper:
        raise ValueError(
            f"`start` {start:g} {unit} lies outside the range of {lower:g} to {upper:g} {unit}"
        )
