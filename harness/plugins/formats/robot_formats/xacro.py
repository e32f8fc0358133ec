"""The robot format `xacro`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from harness.core.geometry import CollisionMode
from harness.language.files.xml_file import XmlElement
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.packages import PackagePath
from harness.robot.robot_format import RobotFormat


class XacroRobot(RobotFormat):
    """URDF in xacro, with its SRDF or with groups that follow from its tree."""

    name: ClassVar[str] = "xacro"

    def read(
        self, spec: RobotSpec, base_dir: Path, collision: CollisionMode | None = None
    ) -> RobotPart:
        """Read the robot."""
        from harness.plugins.formats.robot_files.import_robot import read_robot

        return read_robot(spec, base_dir, collision)

    def render(self, path: Path, args: Mapping[str, Any], packages: PackagePath) -> XmlElement:
        """Replace properties, macros, conditions and includes."""
        from harness.plugins.formats.xacro.render import render

        return render(path, args, packages)
