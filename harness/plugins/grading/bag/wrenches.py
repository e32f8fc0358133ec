"""Readings of sensors of force and torque in a recording."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from harness.core.wrench_sensor import WrenchSensor
from harness.plugins.grading.bag.clocks import Timeline
from harness.plugins.grading.bag.content import BagContent
from harness.plugins.grading.bag.sampling import Trace, first_of_each


def wrench_traces(
    content: BagContent, sensors: Collection[WrenchSensor], timeline: Timeline
) -> dict[str, Trace]:
    """The readings of each sensor over time, by its name; a note on each that has none.

    A topic is that of the sensor whose frame its messages have. Of several topics the one below
    the sensor's name counts, because a driver may publish raw and filtered readings.
    """
    found: dict[str, Trace] = {}
    for sensor in sensors:
        topics = [topic for topic, frame in content.wrenches if frame == sensor.frame_id]
        own = f"/{sensor.name}/wrench"
        chosen = [own] if own in topics else topics
        if len(chosen) != 1:
            content.notes.append(_missing(content, sensor, topics))
            continue
        track = content.wrenches[chosen[0], sensor.frame_id]
        seconds, is_judged = timeline.rows(track, chosen[0])
        if not is_judged.any():
            continue
        times, rows = first_of_each(seconds[is_judged], track.rows()[is_judged])
        still = np.zeros(len(rows) - 1, dtype=bool)
        found[sensor.name] = Trace.of(times, rows, np.diff(rows, axis=0), still)
    return found


def _missing(content: BagContent, sensor: WrenchSensor, topics: Collection[str]) -> str:
    """Why no topic is that of a sensor."""
    if topics:
        return (
            f"the topics {', '.join(sorted(topics))} all have the frame '{sensor.frame_id}' of the"
            f" sensor '{sensor.name}': none of them is read"
        )
    others = ", ".join(f"{topic} has '{frame}'" for topic, frame in sorted(content.wrenches))
    return (
        f"no geometry_msgs/WrenchStamped has the frame '{sensor.frame_id}' of the sensor"
        f" '{sensor.name}'" + (f"; {others}" if others else "")
    )
