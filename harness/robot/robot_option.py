"""What a key of a scenario's robot changes that only some robots have, as a plug-in."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from harness.core.errors import RobotError, RobotOptionError
from harness.core.registry import Plugin, absent_plugins, registry
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.description import RobotDescription

KEYS = ("kinematics", "mount", "moveit")
"""Keys of `robot:` that plug-ins apply, in this order; another plug-in joins `robots`."""


class RobotOption(Plugin):
    """A key of `robot:`, or `robots`; each method changes nothing unless it is overridden."""

    plugin_kind: ClassVar[str] = "robot_option"

    def part(self, main: RobotPart | None, spec: RobotSpec, base_dir: Path) -> RobotPart | None:
        """The arm, before a gripper is mounted on it.

        Raises:
            SpecError: A file has mistakes; each at its place.
            RobotError: A file is not found, or the option does not fit the arm.
        """
        del spec, base_dir
        return main

    def robot(
        self, robot: RobotDescription, spec: RobotSpec, base_dir: Path
    ) -> tuple[RobotDescription, frozenset[str]]:
        """The composed robot, and the joints whose acceleration the option states.

        Raises:
            SpecError: A file has mistakes; each at its place.
            RobotError: A file is not found, or the option does not fit the robot.
        """
        del spec, base_dir
        return robot, frozenset()

    def joined(self, robots: Mapping[str, RobotDescription]) -> RobotDescription:
        """One robot of several, by the names of their arms.

        Raises:
            RobotError: They do not fit each other.
        """
        raise NotImplementedError(f"`{self.name}` joins no robots such as {', '.join(robots)}")


def robot_option(key: str) -> RobotOption:
    """The plug-in of a key.

    Raises:
        RobotError: There is none.
    """
    options = registry(RobotOption.plugin_kind)
    if key not in options:
        why = "; ".join(["no plug-in applies this key here", *absent_plugins()])
        raise RobotOptionError(key, why) if key in KEYS else RobotError(why)
    return options[key]()


def options_of(spec: RobotSpec) -> list[RobotOption]:
    """The plug-ins of the keys that a `robot:` has.

    Raises:
        RobotError: One is missing.
    """
    return [robot_option(key) for key in KEYS if getattr(spec, key) is not None]
