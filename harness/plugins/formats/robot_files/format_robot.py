"""What the readers of other formats make of a robot's file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from harness.core.wrench_sensor import WrenchSensor
from harness.robot.description import NamedState
from harness.robot.srdf.srdf import Srdf
from harness.robot.urdf.urdf import Urdf


@dataclass(frozen=True, eq=False)
class FormatRobot:
    """A robot read from another format.

    Attributes:
        urdf: The tree of the robot.
        states: States of the driven joints; their group is empty.
        disabled: Pairs of links that are not checked for collisions, with the reason.
        wrench_sensors: Sensors of force and torque by name.
        hands: Groups and end effectors of the grippers that the file names.
    """

    urdf: Urdf
    states: tuple[NamedState, ...]
    disabled: Mapping[tuple[str, str], str]
    wrench_sensors: Mapping[str, WrenchSensor] = field(default_factory=dict[str, WrenchSensor])
    hands: Srdf = field(default_factory=Srdf)
