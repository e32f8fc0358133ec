"""What reads a robot's files that have no robot.yaml, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Set
from pathlib import Path
from typing import Any, ClassVar

from harness.core.errors import RobotOptionError
from harness.core.geometry import CollisionMode
from harness.core.registry import Plugin, absent_plugins, registry
from harness.language.files.xml_file import XmlElement, read_xml
from harness.language.scenario import RobotSpec
from harness.robot.compose import RobotPart
from harness.robot.description import RobotDescription
from harness.robot.options import with_options
from harness.robot.packages import PackagePath

FORMATS = ("urdf", "xacro", "mjcf", "sdf")
"""Keys of `robot:` that name a file."""


class RobotFormat(Plugin, ABC):
    """A format of robots' files, selected by the key of `robot:` that names the file."""

    plugin_kind: ClassVar[str] = "robot_format"

    @abstractmethod
    def read(
        self, spec: RobotSpec, base_dir: Path, collision: CollisionMode | None = None
    ) -> RobotPart:
        """Read a robot, and infer what its robot.yaml would say.

        Args:
            collision: How meshes collide whose link the robot's `collision` does not have.

        Raises:
            SpecError: A file has mistakes; each at its place.
            RobotError: A file is not found, or an option does not fit it.
        """

    def with_options(
        self, robot: RobotDescription, spec: RobotSpec, known: Set[str]
    ) -> RobotDescription:
        """Apply the options of `robot:`; a format may first assume limits that its file lacks.

        Raises:
            RobotError: An option refers to an unknown name, or exceeds the robot's limits.
        """
        del known
        return with_options(robot, spec)


def robot_format(spec: RobotSpec) -> RobotFormat:
    """The plug-in that reads the file of a `robot:`.

    Raises:
        RobotError: No plug-in reads the format.
    """
    key = next(key for key in FORMATS if getattr(spec, key) is not None)
    formats = registry(RobotFormat.plugin_kind)
    if key not in formats:
        raise RobotOptionError(key, "; ".join(["no plug-in reads such a file", *absent_plugins()]))
    return formats[key]()


def render_xacro(path: Path, args: Mapping[str, Any], packages: PackagePath) -> XmlElement:
    """The URDF or SRDF that a xacro file computes, each element with its place in the file.

    Args:
        packages: Search path for `$(find ...)`, and the folders that may be read.

    Raises:
        SpecError: The file, or one that it includes, cannot be rendered; or no plug-in renders it.
    """
    formats = registry(RobotFormat.plugin_kind)
    if "xacro" not in formats:
        read_xml(path).refuse("no plug-in renders xacro", "; ".join(absent_plugins()))
    return formats["xacro"]().render(path, args, packages)
