"""The option `mount`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.language.scenario import RobotSpec
from harness.robot.description import RobotDescription
from harness.robot.robot_option import RobotOption


class MountOption(RobotOption):
    """A pedestal and rails under the base of an arm."""

    name: ClassVar[str] = "mount"

    def robot(
        self, robot: RobotDescription, spec: RobotSpec, base_dir: Path
    ) -> tuple[RobotDescription, frozenset[str]]:
        """The robot on its pedestal and rails."""
        from harness.plugins.assembly.keys.mount import MountSpec
        from harness.plugins.assembly.mount import mounted

        del base_dir
        assert isinstance(spec.mount, MountSpec)  # the model of the key
        return mounted(robot, spec.mount), frozenset()
