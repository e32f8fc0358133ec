"""The option `kinematics`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from harness.core.errors import RobotOptionError
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.description import RobotDescription
from harness.robot.robot_option import RobotOption


class CalibrationOption(RobotOption):
    """The measured poses of a UR's joints, as ur_calibration writes them."""

    name: ClassVar[str] = "kinematics"

    def part(self, main: RobotPart | None, spec: RobotSpec, base_dir: Path) -> RobotPart | None:
        """The arm with the poses of the file."""
        from harness.plugins.formats.robot_files.calibration import calibrated
        from harness.robot.find_file import find_file

        path = find_file(spec.kinematics or "", "kinematics", base_dir, ())
        if main is None:
            raise RobotOptionError("kinematics", "a gripper alone has no calibration")
        return replace(main, urdf=replace(main.urdf, joints=calibrated(main.urdf.joints, path)))

    def robot(
        self, robot: RobotDescription, spec: RobotSpec, base_dir: Path
    ) -> tuple[RobotDescription, frozenset[str]]:
        """The robot with a note on the file."""
        del base_dir
        note = f"the joints' poses are those of the calibration {spec.kinematics}"
        return replace(robot, notes=(*robot.notes, note)), frozenset()
