"""Readings of sensors of force and torque as WrenchStamped."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from harness.core.types import FloatArray, IntArray
from harness.core.wrench_sensor import WrenchSensor
from harness.plugins.ros.bag.messages import header, message, vector
from harness.plugins.ros.bag.samples import Message
from harness.plugins.ros.bag.topics import Topic, topic_word
from harness.recording.run import Run

WRENCH = "geometry_msgs/msg/WrenchStamped"


def wrench_topic(sensor: str) -> Topic:
    """The topic of a sensor, below its name."""
    return Topic(f"/{topic_word(sensor)}/wrench", WRENCH)


def wrench_message(head: Any, wrench: FloatArray) -> Any:
    """A reading with a header, shape (6,): force [N], then torque [N m]."""
    content = message(
        "geometry_msgs/msg/Wrench",
        force=vector(wrench[:3].tolist()),
        torque=vector(wrench[3:].tolist()),
    )
    return message(WRENCH, header=head, wrench=content)


def wrenches(run: Run, sensor: WrenchSensor, indices: IntArray) -> Iterator[Message]:
    """The readings of a sensor at samples."""
    if sensor.name not in run.signals.wrenches:
        return
    topic, rows = wrench_topic(sensor.name), run.signals.wrenches[sensor.name]
    for index in indices:
        time = float(run.signals.times[index])
        yield Message(time, topic, wrench_message(header(time, sensor.frame_id), rows[index]))
