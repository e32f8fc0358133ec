"""The readings of a robot's sensors of force and torque, as their topics bring them."""

from __future__ import annotations

import time as wall
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.core.wrench_sensor import WrenchSensor
from harness.plugins.ros.bag.wrenches import WRENCH, wrench_topic
from harness.plugins.ros.endpoints import BEST_EFFORT
from harness.plugins.ros.interfaces import seconds
from harness.plugins.ros.rtps.graph import Graph


class WrenchReadings:
    """Keeps the readings of `/NAME/wrench` of each sensor, in the sensor's axes.

    A message in another frame than the sensor's is none of its readings.
    """

    def __init__(self, graph: Graph, sensors: Mapping[str, WrenchSensor]) -> None:
        self._stamps: dict[str, list[float]] = {name: [] for name in sensors}
        self._rows: dict[str, list[list[float]]] = {name: [] for name in sensors}
        self._arrived = dict.fromkeys(sensors, wall.monotonic())
        self._sensors, self._other_frames = sensors, dict[str, str]()
        for name in sensors:
            topic = wrench_topic(name).name
            graph.subscribe(topic, WRENCH, partial(self._take, name), BEST_EFFORT)

    @property
    def is_complete(self) -> bool:
        """Whether every sensor has sent a reading."""
        return all(self._stamps.values())

    def lack(self, silence: float) -> str:
        """Which sensor has sent no reading for some wall time [s]; empty where all have."""
        for name, stamps in self._stamps.items():
            topic, frame = wrench_topic(name).name, self._sensors[name].frame_id
            if stamps and wall.monotonic() - self._arrived[name] <= silence:
                continue
            if name in self._other_frames:
                return (
                    f"{topic} is in the frame '{self._other_frames[name]}', and the sensor '{name}'"
                    f" of the scenario in '{frame}': give it the link of that frame"
                )
            return f"{topic} has stopped" if stamps else f"{topic} brings no WrenchStamped"
        return ""

    def mean(self, name: str, span: float) -> FloatArray:
        """Mean of the readings of the last `span` seconds, the last one at least, shape (6,)."""
        stamps = self._stamps[name]
        first = int(np.searchsorted(stamps, stamps[-1] - span, side="right"))
        return np.mean(self._rows[name][min(first, len(stamps) - 1) :], axis=0)

    def at(self, name: str, stamps: FloatArray) -> FloatArray:
        """The reading at each of some stamps [s], held until the next one, shape (N, 6).

        Those before the first reading are NaN.
        """
        places = np.searchsorted(self._stamps[name], stamps + 1e-9, side="right")
        return np.vstack([np.full(6, np.nan), *self._rows[name]])[places]

    def _take(self, name: str, content: Any) -> None:
        frame = str(content.header.frame_id)
        if frame not in ("", self._sensors[name].frame_id):
            self._other_frames[name] = frame
            return
        stamp = seconds(content.header.stamp) or wall.monotonic()
        self._arrived[name] = wall.monotonic()
        if not self._stamps[name] or stamp > self._stamps[name][-1]:
            vectors = (content.wrench.force, content.wrench.torque)
            self._stamps[name].append(stamp)
            self._rows[name].append([v for part in vectors for v in (part.x, part.y, part.z)])
