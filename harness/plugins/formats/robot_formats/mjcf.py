"""The robot format `mjcf`."""

from __future__ import annotations

from typing import ClassVar

from harness.plugins.formats.robot_files.file_robot import FileRobot


class MjcfRobot(FileRobot):
    """MuJoCo's MJCF: its bodies, joints, equalities and keyframes."""

    name: ClassVar[str] = "mjcf"
