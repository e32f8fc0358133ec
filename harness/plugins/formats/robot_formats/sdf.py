"""The robot format `sdf`."""

from __future__ import annotations

from typing import ClassVar

from harness.plugins.formats.robot_files.file_robot import FileRobot


class SdfRobot(FileRobot):
    """Gazebo's SDF: the model whose joints move."""

    name: ClassVar[str] = "sdf"
