"""Numbers for the six axes of a frame: along x, y, z and about x, y, z."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field

from harness.core.types import FloatArray
from harness.language.base import Force, SpecModel, Torque
from harness.language.units import quantity

AXES = ("x", "y", "z", "rx", "ry", "rz")
WORDS = ("along x", "along y", "along z", "about x", "about y", "about z")

Stiffness = Annotated[float, BeforeValidator(quantity("N/m")), Field(gt=0)]
TurningStiffness = Annotated[float, BeforeValidator(quantity("N*m/rad")), Field(gt=0)]
Damping = Annotated[float, BeforeValidator(quantity("N*s/m")), Field(gt=0)]
TurningDamping = Annotated[float, BeforeValidator(quantity("N*m*s/rad")), Field(gt=0)]


class _Axes(SpecModel):
    """Numbers of some of the six axes."""

    def named(self) -> tuple[str, ...]:
        """The axes that have a number."""
        return tuple(axis for axis in AXES if getattr(self, axis) is not None)

    def values(self) -> FloatArray:
        """The numbers of all axes, NaN where there is none, shape (6,)."""
        return np.array([getattr(self, axis) for axis in AXES], dtype=float)


class StiffnessAxes(_Axes):
    """Stiffness by axis: the force for each metre, the torque for each radian of deviation."""

    x: Stiffness | None = Field(default=None, description="The stiffness along x [N/m].")
    y: Stiffness | None = Field(default=None, description="The stiffness along y [N/m].")
    z: Stiffness | None = Field(default=None, description="The stiffness along z [N/m].")
    rx: TurningStiffness | None = Field(
        default=None, description="The stiffness of turns about x [N m/rad]."
    )
    ry: TurningStiffness | None = Field(
        default=None, description="The stiffness of turns about y [N m/rad]."
    )
    rz: TurningStiffness | None = Field(
        default=None, description="The stiffness of turns about z [N m/rad]."
    )


class DampingAxes(_Axes):
    """Damping by axis: the force against each metre per second, the torque against each rad/s."""

    x: Damping | None = Field(default=None, description="The damping along x [N s/m].")
    y: Damping | None = Field(default=None, description="The damping along y [N s/m].")
    z: Damping | None = Field(default=None, description="The damping along z [N s/m].")
    rx: TurningDamping | None = Field(
        default=None, description="The damping of turns about x [N m s/rad]."
    )
    ry: TurningDamping | None = Field(
        default=None, description="The damping of turns about y [N m s/rad]."
    )
    rz: TurningDamping | None = Field(
        default=None, description="The damping of turns about z [N m s/rad]."
    )


class WrenchAxes(_Axes):
    """Forces and torques by axis, with which the robot presses; 0 lets the axis give way."""

    x: Force | None = Field(default=None, description="The force along x [N].")
    y: Force | None = Field(default=None, description="The force along y [N].")
    z: Force | None = Field(default=None, description="The force along z [N].")
    rx: Torque | None = Field(default=None, description="The torque about x [N m].")
    ry: Torque | None = Field(default=None, description="The torque about y [N m].")
    rz: Torque | None = Field(default=None, description="The torque about z [N m].")
