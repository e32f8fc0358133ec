"""The key `ros2` of a scenario."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.language.base import Name, RosName, SpecModel
from harness.language.plugin_field import KeyModel


class ControllerKeys(SpecModel):
    """Names of the controllers of one arm on the ROS 2 graph."""

    arm_controllers: tuple[RosName, ...] | None = Field(
        default=None, description="The arm's trajectory controller; each name leads to the same."
    )
    gripper_controller: RosName | None = Field(
        default=None, description="The gripper's controller, of GripperCommand and trajectories."
    )


class Ros2Names(ControllerKeys, KeyModel):
    """Names on the ROS 2 graph, where they differ from the robot's own."""

    key: ClassVar[str] = "ros2"

    arms: dict[Name, ControllerKeys] = Field(
        default_factory=dict,
        description="Names of the controllers of each arm of a robot with several, by the arm's "
        "name.",
    )
    prefix: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,39}$")] | None = Field(
        default=None,
        description="What nodes put before the names of joints and links, such as `left_`.",
    )
