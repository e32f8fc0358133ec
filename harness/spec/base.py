"""The base of every model of a scenario file, and the numbers that may carry a unit."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from harness.spec.units import quantity


class SpecModel(BaseModel):
    """A part of a file: unknown keys refused, immutable, finite numbers only."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


Length = Annotated[float, BeforeValidator(quantity("m"))]
Angle = Annotated[float, BeforeValidator(quantity("rad"))]
Duration = Annotated[float, BeforeValidator(quantity("s")), Field(ge=0)]
Force = Annotated[float, BeforeValidator(quantity("N"))]
Mass = Annotated[float, BeforeValidator(quantity("kg")), Field(gt=0)]
LinearVelocity = Annotated[float, BeforeValidator(quantity("m/s"))]
AngularVelocity = Annotated[float, BeforeValidator(quantity("rad/s"))]
LinearAcceleration = Annotated[float, BeforeValidator(quantity("m/s**2"))]
JointValue = Annotated[float, BeforeValidator(quantity("rad", "m"))]
JointEffort = Annotated[float, BeforeValidator(quantity("N*m", "N"))]

PositiveLength = Annotated[Length, Field(gt=0)]
NonNegativeLength = Annotated[Length, Field(ge=0)]
NonNegativeAngle = Annotated[Angle, Field(ge=0)]
PositiveDuration = Annotated[Duration, Field(gt=0)]
Fraction = Annotated[float, Field(gt=0, le=1)]

Xyz = tuple[Length, Length, Length]
Rpy = tuple[Angle, Angle, Angle]
Quaternion = tuple[float, float, float, float]
Color = tuple[
    Annotated[float, Field(ge=0, le=1)],
    Annotated[float, Field(ge=0, le=1)],
    Annotated[float, Field(ge=0, le=1)],
    Annotated[float, Field(ge=0, le=1)],
]
Name = Annotated[str, Field(min_length=1, max_length=100)]
