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
    """Keeps what is published of each joint, which several drivers may share.

    `/joint_states` and, of several arms, `/ARM/joint_states` are read. The record begins when every
    joint that is no mimic joint is known, and ends with the joint whose last state is the oldest.
    """

    def __init__(self, graph: Graph, description: RobotDescription) -> None:
        self._description = description
        joints = description.movable_joints
        self._driven = [joint.name for joint in joints if joint.mimic is None]
        self._stamps: dict[str, list[float]] = {joint.name: [] for joint in joints}
        self._rows: dict[str, list[list[float]]] = {joint.name: [] for joint in joints}
        self._arrived = dict.fromkeys(self._driven, wall.monotonic())
        for space in ("", *(f"/{arm.name}" for arm in description.arms)):
            topic = f"{space}/joint_states"
            graph.subscribe(topic, "sensor_msgs/msg/JointState", self._take, BEST_EFFORT)

    @property
    def missing(self) -> list[str]:
        """Names of the joints of which nothing has come."""
        return [name for name in self._driven if not self._stamps[name]]

    @property
    def origin(self) -> float:
        """The stamp at which the record begins [s]: then every joint is known."""
        return max(self._stamps[name][0] for name in self._driven)

    @property
    def time(self) -> float:
        """Time of which every joint is known [s]; -1 before."""
        if self.missing:
            return -1.0
        return max(min(self._stamps[name][-1] for name in self._driven) - self.origin, -1.0)

    @property
    def silence(self) -> float:
        """Wall time since the last state of the joint that has been silent for longest [s]."""
        return wall.monotonic() - min(self._arrived.values())

    @property
    def sample_count(self) -> int:
        """Samples on the grid so far."""
        return int(self.time / GRID + 1e-9) + 1

    @property
    def positions(self) -> FloatArray:
        """The last positions, description order."""
        last = [rows[-1][0] if rows else 0.0 for rows in self._rows.values()]
        return self._description.with_mimics(np.array(last))

    @property
    def speed(self) -> float:
        """The largest speed of a joint in its last state [rad/s or m/s]."""
        return max(abs(rows[-1][1]) for rows in self._rows.values() if rows)

    def record(self) -> tuple[FloatArray, FloatArray]:
        """Times (N,) on the grid, and positions, velocities and efforts at them, (3, N, n)."""
        times = np.arange(self.sample_count, dtype=np.float64) * GRID
        even = np.zeros((3, len(times), len(self._rows)))
        for place, (name, rows) in enumerate(self._rows.items()):
            if rows:
                arrived = np.array(self._stamps[name]) - self.origin
                for part, column in zip(even, np.array(rows).T, strict=True):
                    part[:, place] = np.interp(times, arrived, column)
        even[0] = [self._description.with_mimics(row) for row in even[0]]
        return times, even

    def _take(self, state: Any) -> None:
        stamp = seconds(state.header.stamp) or wall.monotonic()
        parts = (state.position, state.velocity, state.effort)
        known = [values if len(values) >= len(state.name) else None for values in parts]
        for index, joint in enumerate(map(str, state.name)):
            stamps = self._stamps.get(joint)
            if stamps is None or known[0] is None:
                continue
            if joint in self._arrived:
                self._arrived[joint] = wall.monotonic()
            if not stamps or stamp > stamps[-1]:
                stamps.append(stamp)
                row = [0.0 if values is None else float(values[index]) for values in known]
                self._rows[joint].append(row)
