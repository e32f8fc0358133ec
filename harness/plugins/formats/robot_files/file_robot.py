"""A robot of a format of this plug-in."""

from __future__ import annotations

from collections.abc import Set
from pathlib import Path

from harness.core.geometry import CollisionMode
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.description import RobotDescription
from harness.robot.options import with_options
from harness.robot.robot_format import RobotFormat


class FileRobot(RobotFormat):
    """A robot of which files lack what a robot.yaml says."""

    def read(
        self, spec: RobotSpec, base_dir: Path, collision: CollisionMode | None = None
    ) -> RobotPart:
        """Read the robot."""
        from harness.plugins.formats.robot_files.import_robot import read_robot

        return read_robot(spec, base_dir, collision)

    def with_options(
        self, robot: RobotDescription, spec: RobotSpec, known: Set[str]
    ) -> RobotDescription:
        """Apply options, and assume the limits that are stated nowhere."""
        from harness.plugins.formats.robot_files.assumed_limits import (
            with_assumed_limits_listed,
            with_plausible_efforts,
        )

        own = {name for name, limits in spec.joint_limits.items() if limits.max_acceleration}
        robot = with_options(with_plausible_efforts(robot), spec)
        return with_assumed_limits_listed(robot, known | own)
