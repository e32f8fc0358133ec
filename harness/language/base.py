"""The base of every model of a scenario file, and the numbers that may carry a unit."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self, cast

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    Strict,
    field_validator,
    model_validator,
)

from harness.core.limits import LONGEST_NAME
from harness.language.colors import color_of_name
from harness.language.files.mistakes import MistakeError
from harness.language.units import quantity

LARGEST_NUMBER = 1e9  # SI units; beyond it, squares and distances overflow


SMALLEST_SIZE = 1e-9  # of a length or mass that has to be above zero [m or kg]


def refuse_beyond(value: Any) -> None:
    """Refuse a field's value with a number beyond `LARGEST_NUMBER`."""
    match value:
        case float() if abs(value) > LARGEST_NUMBER:
            raise MistakeError(f"{value:g} is too large", f"at most {LARGEST_NUMBER:g} in SI units")
        case tuple() | list():
            for item in cast("list[Any]", value):
                refuse_beyond(item)
        case dict():
            for item in cast("dict[Any, Any]", value).values():
                refuse_beyond(item)
        case _:
            pass


def refuse_tiny(value: float) -> float:
    """A length or mass above zero that physics can work with.

    Raises:
        MistakeError: It is so small that volumes and inertias become zero.
    """
    if 0 < value < SMALLEST_SIZE:
        raise MistakeError(f"{value:g} is too small", f"at least {SMALLEST_SIZE:g} m or kg")
    return value


def refuse_percent(value: Any) -> Any:
    """A share of a whole, as it is written.

    Raises:
        MistakeError: It is a number of 2 or more, as one in percent is.
    """
    if isinstance(value, int | float) and value >= 2:
        raise MistakeError(f"must be at most 1, not `{value:g}`", f"write `{value:g} %`")
    return value


def refuse_metres(value: float) -> float:
    """A distance from where something is to be, in metres.

    Raises:
        MistakeError: It is a metre or more, as numbers in millimetres without their unit are.
    """
    if value >= 1:
        hint = f"write `{value:g} mm` for millimetres"
        raise MistakeError(f"must be less than 1 m, not `{value:g}` m", hint)
    return value


class SpecModel(BaseModel):
    """A part of a file: unknown keys refused, immutable, numbers finite and bounded.

    Attributes:
        short: The field that a bare value stands for: `- gripper: open` is short for
            `- gripper: {named_target: open}`; empty where there is none.
        short_is_list: Whether that field is a list, and one value alone a list of one.
        one_of: Fields of which exactly one is given.
        some_of: Fields of which at least one is given.
        goes_with: Fields that say nothing unless one of others is given, by their names.
    """

    short: ClassVar[str] = ""
    short_is_list: ClassVar[bool] = False
    one_of: ClassVar[tuple[str, ...]] = ()
    some_of: ClassVar[tuple[str, ...]] = ()
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {}

    model_config = ConfigDict(  # built when first used, each with those in it: most never are
        extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True, defer_build=True
    )

    @classmethod
    def unknown_key_hint(cls, key: str, content: Mapping[str, Any]) -> str:
        """What to write instead of a key of other programs, given all keys next to it."""
        del key, content
        return ""

    @field_validator("*")
    @classmethod
    def _bounded(cls, value: Any) -> Any:
        refuse_beyond(value)
        return value

    @model_validator(mode="before")
    @classmethod
    def _from_short_form(cls, value: Any) -> Any:
        given: object = value
        if not cls.short or isinstance(given, dict | BaseModel):
            return value
        is_one = cls.short_is_list and not isinstance(given, list | tuple)
        return {cls.short: [value] if is_one else value}

    @model_validator(mode="after")
    def _alternatives(self) -> Self:
        for keys, number, most in (
            (self.one_of, "exactly one", 1),
            (self.some_of, "at least one", len(self.some_of)),
        ):
            stated = [f"`{key}`" for key in keys if getattr(self, key) is not None]
            if keys and not 1 <= len(stated) <= most:
                *first, last = (f"`{key}`" for key in keys)
                found = " and ".join(stated) or "none"
                raise ValueError(
                    f"{number} of {', '.join(first)} and {last} is needed; found {found}"
                )
        given = {key for key in self.model_fields_set if getattr(self, key) is not None}
        for key in given.intersection(self.goes_with):
            others = self.goes_with[key]
            if given.isdisjoint(others):
                raise ValueError(f"`{key}` goes with {' or '.join(f'`{each}`' for each in others)}")
        return self


Number = Annotated[float, Strict()]
Count = Annotated[int, Strict(), Field(ge=0)]
Flag = Annotated[bool, Strict()]

Share = Annotated[float, BeforeValidator(quantity("1"))]
Rate = Annotated[float, BeforeValidator(quantity("Hz"))]
Length = Annotated[float, BeforeValidator(quantity("m"))]
Angle = Annotated[float, BeforeValidator(quantity("rad"))]
Duration = Annotated[float, BeforeValidator(quantity("s")), Field(ge=0)]
Force = Annotated[float, BeforeValidator(quantity("N"))]
Torque = Annotated[float, BeforeValidator(quantity("N*m"))]
Mass = Annotated[float, BeforeValidator(quantity("kg")), Field(gt=0), AfterValidator(refuse_tiny)]
LinearVelocity = Annotated[float, BeforeValidator(quantity("m/s"))]
AngularVelocity = Annotated[float, BeforeValidator(quantity("rad/s"))]
JointVelocity = Annotated[float, BeforeValidator(quantity("rad/s", "m/s"))]
JointAcceleration = Annotated[float, BeforeValidator(quantity("rad/s**2", "m/s**2"))]
JointJerk = Annotated[float, BeforeValidator(quantity("rad/s**3", "m/s**3"))]
LinearAcceleration = Annotated[float, BeforeValidator(quantity("m/s**2"))]
RestSpeed = Annotated[LinearVelocity, Field(gt=0, le=1)]
RestTurning = Annotated[AngularVelocity, Field(gt=0, le=10)]
"""The largest speed at which something still counts as at rest; what moves faster never does."""
JointValue = Annotated[float, BeforeValidator(quantity("rad", "m"))]
"""A joint's position: rad where it turns, m where it slides; an `Angle` refuses the latter."""
JointEffort = Annotated[float, BeforeValidator(quantity("N*m", "N"))]

PositiveLength = Annotated[Length, Field(gt=0), AfterValidator(refuse_tiny)]
NonNegativeLength = Annotated[Length, Field(ge=0)]
Deviation = Annotated[PositiveLength, AfterValidator(refuse_metres)]  # from where it is to be
AngleBetween = Annotated[Angle, Field(le=math.pi)]  # of two directions, never beyond pi
NonNegativeAngle = Annotated[Angle, Field(ge=0)]
PositiveDuration = Annotated[Duration, Field(gt=0)]
Fraction = Annotated[Share, BeforeValidator(refuse_percent), Field(gt=0, le=1)]
"""A share of a whole."""

Xyz = tuple[Length, Length, Length]
Rpy = tuple[Angle, Angle, Angle]
Quaternion = tuple[Number, Number, Number, Number]
ColorPart = Annotated[Number, Field(ge=0, le=1)]
Color = Annotated[tuple[ColorPart, ColorPart, ColorPart, ColorPart], BeforeValidator(color_of_name)]


def kind_of(value: Any) -> str:
    """`many` for a mapping, list or model, `one` for anything else: it selects a union's branch."""
    return "many" if isinstance(value, dict | list | tuple | BaseModel) else "one"


Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME)]


def _ros_name(name: str) -> str:
    if not re.fullmatch(r"[a-z_]\w*(/[a-z_]\w*)*", name, re.ASCII | re.IGNORECASE):
        raise ValueError("ROS 2 takes letters, digits and `_`, no digit first, and `/` in between")
    return name


RosName = Annotated[Name, AfterValidator(_ros_name)]
