"""The robot format `urdf`."""

from __future__ import annotations

from typing import ClassVar

from harness.plugins.formats.robot_files.file_robot import FileRobot


class UrdfRobot(FileRobot):
    """URDF, with its SRDF or with groups that follow from its tree."""

    name: ClassVar[str] = "urdf"
