"""The robot format `xacro`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.robot_files.file_robot import FileRobot
from harness.robot.packages import PackagePath


class XacroRobot(FileRobot):
    """URDF in xacro, with its SRDF or with groups that follow from its tree."""

    name: ClassVar[str] = "xacro"

    def render(self, path: Path, args: Mapping[str, Any], packages: PackagePath) -> XmlElement:
        """Replace properties, macros, conditions and includes."""
        from harness.plugins.formats.xacro.render import render

        return render(path, args, packages)
