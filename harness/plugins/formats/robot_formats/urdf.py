"""The robot format `urdf`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.core.geometry import CollisionMode
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.robot_format import RobotFormat


class UrdfRobot(RobotFormat):
    """URDF, with its SRDF or with groups that follow from its tree."""

    name: ClassVar[str] = "urdf"

    def read(
        self, spec: RobotSpec, base_dir: Path, collision: CollisionMode | None = None
    ) -> RobotPart:
        """Read the robot."""
        from harness.plugins.formats.robot_files.import_robot import read_robot

        return read_robot(spec, base_dir, collision)
