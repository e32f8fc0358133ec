"""The robot format `mjcf`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.robot.packages import PackagePath
from harness.robot.robot_format import FormatRobot, RobotFormat


class MjcfRobot(RobotFormat):
    """MuJoCo's MJCF: its bodies, joints, equalities and keyframes."""

    name: ClassVar[str] = "mjcf"

    def read(self, path: Path, packages: PackagePath) -> FormatRobot:
        """Read the robot."""
        from harness.plugins.formats.mjcf_robot.mjcf import read_mjcf

        return read_mjcf(path, packages)
