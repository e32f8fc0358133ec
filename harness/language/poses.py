"""Poses, positions and directions as a file writes them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, field_validator, model_validator

from harness.core.amounts import point_text
from harness.language.base import (
    AngleBetween,
    Deviation,
    Name,
    Number,
    Quaternion,
    Rpy,
    SpecModel,
    Xyz,
)

if TYPE_CHECKING:
    from harness.core.spatial import SE3

QUATERNION_NORM_TOLERANCE = 1e-2  # of the length of a written quaternion, whose digits are rounded


def _in_frame(text: str, frame: str) -> str:
    """The text, with its frame where this is not the default."""
    return text if frame == "world" else f"{text} in {frame}"


class Pose(SpecModel):
    """A pose: a position and at most one of `rpy`, `quat_xyzw`, `quat_wxyz`, in a frame."""

    xyz: Xyz = Field(
        default=(0.0, 0.0, 0.0), description="The position along x, y, z of the frame [m]."
    )
    rpy: Rpy | None = Field(
        default=None, description="The fixed-axis roll, pitch and yaw [rad], as in URDF."
    )
    quat_xyzw: Quaternion | None = Field(default=None, description="The quaternion in ROS order.")
    quat_wxyz: Quaternion | None = Field(
        default=None, description="The quaternion in MuJoCo's order."
    )
    frame: Name = Field(
        default="world", description="The frame: `world`, a robot link, or an object's name."
    )

    @field_validator("quat_xyzw", "quat_wxyz")
    @classmethod
    def _norm(cls, value: Quaternion | None) -> Quaternion | None:
        if value is None:
            return None
        norm = math.sqrt(sum(part * part for part in value))
        if abs(norm - 1) > QUATERNION_NORM_TOLERANCE:
            hint = "no rotation is (0, 0, 0, 1) in xyzw order"
            if norm > 0:
                hint = (
                    "normalised it is [" + ", ".join(f"{part / norm:.6g}" for part in value) + "]"
                )
            raise ValueError(f"a quaternion has norm 1, this one {norm:.4g}; {hint}")
        return value

    @model_validator(mode="after")
    def _one_rotation(self) -> Pose:
        given = [key for key in ("rpy", "quat_xyzw", "quat_wxyz") if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"a pose has one rotation; this one has {' and '.join(given)}")
        return self

    @property
    def has_rotation(self) -> bool:
        """Whether the file gives one."""
        return any(part is not None for part in (self.rpy, self.quat_xyzw, self.quat_wxyz))

    def place(self) -> str:
        """Its position alone: `(320, -170, 80) mm in base_link`."""
        return _in_frame(point_text(self.xyz), self.frame)

    def text(self) -> str:
        """The pose in mm and degrees: `(320, -170, 80) mm, rpy (180, 0, -45) deg, in base_link`."""
        turn = ""
        if self.has_rotation:
            from harness.core.spatial import rpy_from_rotation

            angles = self.rpy or rpy_from_rotation(self.se3().rotation).tolist()
            turn = f", rpy ({', '.join(f'{math.degrees(each):.1f}' for each in angles)}) deg"
        return _in_frame(point_text(self.xyz) + turn, self.frame)

    def se3(self) -> SE3:
        """The pose in its frame: T_frame_this, quaternion normalised."""
        from harness.core.spatial import SE3, wxyz_from_xyzw  # NumPy: 0.1 s, not needed to load

        if self.rpy is not None:
            return SE3.from_xyz_rpy(self.xyz, self.rpy)
        if self.quat_xyzw is not None:
            return SE3.from_xyz_quat(self.xyz, wxyz_from_xyzw(self.quat_xyzw))
        if self.quat_wxyz is not None:
            return SE3.from_xyz_quat(self.xyz, self.quat_wxyz)
        return SE3.from_xyz_rpy(self.xyz)


class Position(SpecModel):
    """A position: a point in a frame."""

    short = "xyz"

    xyz: Xyz = Field(description="The position along x, y, z of the frame [m].")
    frame: Name = Field(
        default="world", description="The frame: `world`, a robot link, or an object's name."
    )

    def place(self) -> str:
        """The position in mm: `(320, -170, 80) mm in base_link`."""
        return _in_frame(point_text(self.xyz), self.frame)

    text = place


class Direction(SpecModel):
    """A direction of travel, or an axis to turn about; its length does not matter."""

    xyz: tuple[Number, Number, Number] = Field(
        description="The components along x, y, z of the frame."
    )
    frame: Name = Field(
        default="world", description="The frame: `world`, a robot link, or an object's name."
    )

    @field_validator("xyz")
    @classmethod
    def _not_zero(cls, value: tuple[float, float, float]) -> tuple[float, float, float]:
        if math.sqrt(sum(part * part for part in value)) < 1e-9:
            raise ValueError("a direction has some length; this one is (0, 0, 0)")
        return value


class PoseTolerance(SpecModel):
    """The tolerance of a pose: MoveIt's goal tolerances."""

    position: Deviation = Field(default=1e-3, description="The radius around the target [m].")
    orientation: Annotated[AngleBetween, Field(ge=0)] = Field(
        default=1e-2, description="The largest rotation about each axis [rad]."
    )
