"""The key `moveit` of a robot."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from harness.language.plugin_field import KeyModel


class MoveItFiles(KeyModel):
    """The files of a MoveIt configuration package."""

    key: ClassVar[str] = "moveit"

    joint_limits: str | None = Field(
        default=None, description="The path of joint_limits.yaml, which narrows the robot's limits."
    )
    kinematics: str | None = Field(
        default=None,
        description="The path of kinematics.yaml; `position_only_ik` of each group is read.",
    )
