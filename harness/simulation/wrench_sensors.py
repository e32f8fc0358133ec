"""Readings of sensors of force and torque: MuJoCo's sums, held at a rate, with noise and tare."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from zlib import crc32

import mujoco
import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.core.wrench_sensor import Payload, WrenchSensor

BLOCK = 1024
"""Readings whose noise is drawn at once: one look draws no more than its own blocks."""

KINDS = mujoco.mjtSensor.mjSENS_FORCE, mujoco.mjtSensor.mjSENS_TORQUE


@dataclass(frozen=True, eq=False)
class Tare:
    """What a sensor takes for zero since a sample, shape (6,), besides the weight of a payload."""

    row: int
    sensor: str
    zero: FloatArray
    payload: Payload | None = None


def add_wrench_sensors(spec: mujoco.MjSpec, sensors: Iterable[WrenchSensor]) -> None:
    """Add a site and two sensors of MuJoCo for each sensor, six numbers of each sample."""
    for sensor in sensors:
        site = spec.body(sensor.link).add_site(name=f"wrench {sensor.name}")
        site.pos, site.quat = sensor.pose.translation, sensor.pose.quat_wxyz
        for kind in KINDS:
            spec.add_sensor(type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=site.name)


class WrenchSensors:
    """The readings of all sensors, which follow from what MuJoCo measures at each sample.

    A reading does not depend on when it is looked at: the noise of a sensor is one sequence from
    the run's seed and its place, or its name in a cell, drawn in blocks; a reading has a row of it.
    """

    def __init__(
        self, sensors: Iterable[WrenchSensor], timestep: float, seed: int, *, is_cell: bool = False
    ) -> None:
        self.sensors = {sensor.name: sensor for sensor in sensors}
        self._timestep, self._seed, self._is_cell = timestep, seed, is_cell
        self._tares: list[Tare] = []

    def rewind(self, count: int) -> None:
        """Forget the tares of all samples after the first `count`."""
        self._tares = [tare for tare in self._tares if tare.row < count]

    def tare(self, tare: Tare) -> None:
        """Take a wrench for zero from a sample on, without earlier tares."""
        self._tares.append(tare)

    def payloads(self, name: str) -> list[tuple[int, Payload | None]]:
        """Since which samples which payload's weight is subtracted from a sensor's readings."""
        return [(tare.row, tare.payload) for tare in self._tares if tare.sensor == name]

    def rows_read(self, name: str, first: int, count: int) -> tuple[IntArray, IntArray]:
        """Number and sample of the reading that a sensor has at samples, shape (count,) each."""
        rows, steps = np.arange(first, first + count), self.sensors[name].rate * self._timestep
        if steps >= 1:
            return rows, rows
        numbers = np.floor(rows * self._timestep * self.sensors[name].rate + 1e-9).astype(np.int64)
        return numbers, np.ceil(numbers / steps - 1e-9).astype(np.int64)

    def readings(
        self, name: str, measured: FloatArray, first: int, count: int, *, tared: bool = True
    ) -> FloatArray:
        """What a sensor reads from a sample on, as wrenches in its axes, shape (count, 6).

        Args:
            measured: MuJoCo's numbers of all sensors at every sample, shape (N, 6 * sensors).
        """
        sensor = self.sensors[name]
        column = 6 * list(self.sensors).index(name)
        numbers, rows = self.rows_read(name, first, count)
        wrenches = -measured[rows, column : column + 6]  # MuJoCo has the force of the link before
        deviations = np.repeat([sensor.force_noise, sensor.torque_noise], 3)
        if deviations.any():
            place = crc32(name.encode()) if self._is_cell else column
            wrenches += deviations * self._noise(place, numbers)
        zero = np.zeros_like(wrenches)
        for tare in self._tares if tared else ():
            if tare.sensor == name:
                zero[max(0, tare.row - first) :] = tare.zero
        return wrenches - zero

    def _noise(self, place: int, numbers: IntArray) -> FloatArray:
        """Normally distributed numbers of readings, whose numbers ascend, shape (n, 6)."""
        first, last = int(numbers[0]) // BLOCK, int(numbers[-1]) // BLOCK
        blocks = [
            np.random.default_rng([self._seed, place, block]).standard_normal((BLOCK, 6))
            for block in range(first, last + 1)
        ]
        return np.concatenate(blocks)[numbers - first * BLOCK]
