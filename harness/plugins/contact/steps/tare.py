"""tare: a sensor of force and torque takes what it reads now for zero."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.core.types import Floats
from harness.core.wrench_sensor import Payload
from harness.language.base import Mass, Name, PositiveDuration, SpecModel, Xyz
from harness.plugins.contact.sensors import check_sensor, sensor_of


@dataclass(frozen=True)
class Tared(Detail):
    """What a sensor took for zero: force along x, y, z [N], then torque [N m], in its axes."""

    sensor: str
    zero: Floats


class PayloadSpec(SpecModel):
    """What a sensor carries."""

    mass: Mass = Field(description="The mass [kg].")
    com: Xyz = Field(
        default=(0.0, 0.0, 0.0),
        description="The centre of mass in the axes of the link that the sensor carries first [m].",
    )


class Tare(Step):
    """Let a sensor of force and torque take what it reads now for zero.

    The arm stands during `duration`, and the mean of the readings in it is subtracted from all
    later ones, in place of an earlier tare. The weight of what the sensor carries is gone from its
    readings only as long as the sensor keeps its orientation; that of a `payload` is subtracted in
    every orientation, until the next tare.
    """

    short = "sensor"
    verb: ClassVar[str] = "tare"
    plans: ClassVar[bool] = False
    synonyms = ("zero_ftsensor", "zero_sensor")
    keeps_arm_still: ClassVar[bool] = True
    results = (Tared,)

    sensor: Name | None = Field(
        default=None, description="The name of the sensor; the default is the only one."
    )
    duration: PositiveDuration = Field(
        default=0.1, description="The readings are averaged over this duration [s]."
    )

    payload: PayloadSpec | None = Field(
        default=None,
        description="What the sensor carries: a tool, an object that is held, or both.",
    )

    def summary(self) -> str:
        return self.sensor or "the sensor"

    def check(self, at: At) -> None:
        check_sensor(self.sensor, at)
        at.scope.take_time(self.duration, at.key("duration"))

    def execute(self, cell: Cell) -> None:
        """Hold, then take the mean of the readings for zero."""
        sensor = sensor_of(cell.robot, self.sensor)
        payload = self.payload and Payload(self.payload.mass, np.array(self.payload.com))
        zero = cell.simulator.tare(sensor.name, self.duration, payload)
        cell.report(Tared(sensor.name, tuple(zero.tolist())))
