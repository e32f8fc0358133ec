"""What reads a robot's file in the format of another program, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from harness.core.errors import RobotOptionError
from harness.core.registry import Plugin, absent_plugins, registry
from harness.core.wrench_sensor import WrenchSensor
from harness.robot.description import NamedState
from harness.robot.packages import PackagePath
from harness.robot.urdf.urdf import Urdf


@dataclass(frozen=True, eq=False)
class FormatRobot:
    """A robot read from another format.

    Attributes:
        urdf: The tree of the robot.
        states: States of the driven joints; their group is empty.
        disabled: Pairs of links that are not checked for collisions, with the reason.
        wrench_sensors: Sensors of force and torque by name.
    """

    urdf: Urdf
    states: tuple[NamedState, ...]
    disabled: Mapping[tuple[str, str], str]
    wrench_sensors: Mapping[str, WrenchSensor] = field(default_factory=dict[str, WrenchSensor])


class RobotFormat(Plugin, ABC):
    """A format of robots' files, selected by the key of `robot:` that names the file."""

    plugin_kind: ClassVar[str] = "robot_format"

    @abstractmethod
    def read(self, path: Path, packages: PackagePath) -> FormatRobot:
        """Read a robot.

        Args:
            path: The path of the file.
            packages: The folders that may be read.

        Raises:
            SpecError: The file has mistakes; each at its place.
        """


def read_foreign_robot(key: str, path: Path, packages: PackagePath) -> FormatRobot:
    """The robot of a file that a key of `robot:` names.

    Raises:
        SpecError: The file has mistakes.
        RobotOptionError: No plug-in reads the format.
    """
    formats = registry(RobotFormat.plugin_kind)
    if key not in formats:
        raise RobotOptionError(key, "; ".join(["no plug-in reads such a file", *absent_plugins()]))
    return formats[key]().read(path, packages)
