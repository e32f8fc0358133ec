"""The option `moveit`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from harness.language.scenario import RobotSpec
from harness.robot.description import RobotDescription
from harness.robot.robot_option import RobotOption


class MoveItOption(RobotOption):
    """Limits of MoveIt's joint_limits.yaml, and `position_only_ik` of its kinematics.yaml."""

    name: ClassVar[str] = "moveit"

    def robot(
        self, robot: RobotDescription, spec: RobotSpec, base_dir: Path
    ) -> tuple[RobotDescription, frozenset[str]]:
        """The robot with the limits of the files, and the joints with an acceleration there."""
        from harness.plugins.formats.keys.moveit import MoveItFiles
        from harness.plugins.formats.robot_files import moveit_files
        from harness.robot.find_file import find_file
        from harness.robot.urdf.write import write_urdf

        given, files = frozenset[str](), spec.moveit
        assert isinstance(files, MoveItFiles)  # the model of the key
        if files.joint_limits is not None:
            path, notes = find_file(files.joint_limits, "moveit", base_dir, ()), list(robot.notes)
            joints, given = moveit_files.with_joint_limits(robot.joints, path, robot.name, notes)
            urdf = write_urdf(robot.name, robot.links, joints)
            robot = replace(robot, joints=joints, urdf=urdf, notes=tuple(notes))
        if files.kinematics is not None:
            path = find_file(files.kinematics, "moveit", base_dir, ())
            only = moveit_files.position_only_groups(path, robot.groups, robot.name)
            robot = replace(robot, position_only_groups=only)
        return robot, given
