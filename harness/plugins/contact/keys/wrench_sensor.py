"""A sensor of force and torque."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.core.spatial import SE3
from harness.core.wrench_sensor import WrenchSensor
from harness.language.base import Force, Name, Rate, Rpy, Torque, Xyz
from harness.language.scenario import WrenchSensorKey


class WrenchSensorSpec(WrenchSensorKey):
    """A sensor of force and torque between a link and the link before it.

    It measures with what force and torque the link, and all that it carries, acts on the link
    before it: a load that hangs pulls it down, a table on which the tool presses pushes it up.
    """

    key: ClassVar[str] = "wrench_sensor"
    short = "link"

    link: Name = Field(
        description="The first link that the sensor carries; the sensor is in the joint before it."
    )
    xyz: Xyz = Field(
        default=(0.0, 0.0, 0.0),
        description="The origin of the sensor in the axes of the link [m]; torques are about it.",
    )
    rpy: Rpy = Field(
        default=(0.0, 0.0, 0.0),
        description="The axes of the sensor as fixed-axis roll, pitch, yaw in those of the link.",
    )
    rate: Annotated[Rate, Field(gt=0)] | None = Field(
        default=None,
        description="Readings in a second of simulated time, each held until the next; by default"
        " one at every step of the physics.",
    )
    force_noise: Annotated[Force, Field(ge=0)] = Field(
        default=0.0,
        description="The standard deviation of white noise on each component of the force [N],"
        " from the run's seed.",
    )
    torque_noise: Annotated[Torque, Field(ge=0)] = Field(
        default=0.0,
        description="The standard deviation of white noise on each component of the torque [N m].",
    )

    def sensor(self, name: str) -> WrenchSensor:
        """The sensor under a name."""
        return WrenchSensor(
            name,
            self.link,
            SE3.from_xyz_rpy(self.xyz, self.rpy),
            float("inf") if self.rate is None else self.rate,
            self.force_noise,
            self.torque_noise,
        )
