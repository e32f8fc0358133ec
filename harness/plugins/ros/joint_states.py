"""The joint states of a robot as they arrive, and the even record that is made of them."""

from __future__ import annotations

import time as wall
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.plugins.ros.endpoints import BEST_EFFORT
from harness.plugins.ros.interfaces import seconds
from harness.plugins.ros.rtps.graph import Graph
from harness.robot.description import RobotDescription

GRID = 0.01  # time between the samples of the record [s]; joint states are interpolated onto it


class JointStates:
    """Keeps every message of `/joint_states` that has all joints which are no mimic joints."""

    def __init__(self, graph: Graph, description: RobotDescription) -> None:
        self._description = description
        self._stamps: list[float] = []
        self._rows: list[FloatArray] = []
        self._arrived = wall.monotonic()
        graph.subscribe("/joint_states", "sensor_msgs/msg/JointState", self._take, BEST_EFFORT)

    @property
    def time(self) -> float:
        """Time of the last message since the first one [s]; -1 before the first one."""
        return self._stamps[-1] - self._stamps[0] if self._stamps else -1.0

    @property
    def silence(self) -> float:
        """Wall time since the last message [s]."""
        return wall.monotonic() - self._arrived

    @property
    def sample_count(self) -> int:
        """Samples on the grid so far."""
        return int(self.time / GRID + 1e-9) + 1

    @property
    def positions(self) -> FloatArray:
        """The last positions, description order."""
        return self._rows[-1][0].copy()

    @property
    def speed(self) -> float:
        """The largest speed of a joint in the last message [rad/s or m/s]."""
        return float(np.abs(self._rows[-1][1]).max())

    def record(self) -> tuple[FloatArray, FloatArray]:
        """Times (N,) on the grid, and positions, velocities and efforts at them, (3, N, n)."""
        times = np.arange(self.sample_count, dtype=np.float64) * GRID
        arrived = np.array(self._stamps) - self._stamps[0]
        columns = np.array(self._rows).reshape(len(self._rows), -1).T
        even = np.array([np.interp(times, arrived, column) for column in columns])
        return times, even.reshape(3, -1, len(times)).swapaxes(1, 2)

    def _take(self, state: Any) -> None:
        self._arrived = wall.monotonic()
        place = {str(name): index for index, name in enumerate(state.name)}
        joints = self._description.movable_joints
        if any(joint.mimic is None and joint.name not in place for joint in joints):
            return
        stamp = seconds(state.header.stamp) or wall.monotonic()
        if self._stamps and stamp <= self._stamps[-1]:
            return
        row = np.zeros((3, len(joints)))
        for part, values in zip(row, (state.position, state.velocity, state.effort), strict=True):
            if len(values) >= len(place):
                part[:] = [values[place[j.name]] if j.name in place else 0.0 for j in joints]
        row[0] = self._description.with_mimics(row[0])
        self._stamps.append(stamp)
        self._rows.append(row)
