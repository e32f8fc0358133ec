"""The robot format `mjcf`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.core.geometry import CollisionMode
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.robot_format import RobotFormat


class MjcfRobot(RobotFormat):
    """MuJoCo's MJCF: its bodies, joints, equalities and keyframes."""

    name: ClassVar[str] = "mjcf"

    def read(
        self, spec: RobotSpec, base_dir: Path, collision: CollisionMode | None = None
    ) -> RobotPart:
        """Read the robot."""
        from harness.plugins.formats.robot_files.import_robot import read_robot

        return read_robot(spec, base_dir, collision)
