"""The files that an imported robot's file names, and the arguments that they take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.core.errors import RobotOptionError
from harness.language.files.xml_file import read_xml
from harness.robot.packages import PackagePath
from harness.robot.xacro_file import arguments_of, is_xacro


def files_around(name: str, path: Path, given: Sequence[Path]) -> PackagePath:
    """Where the files are that a robot's file names; of package://name/path, in all of its package.

    Args:
        name: The word by which the scenario names the robot's file.
        path: The path of the robot's file.
        given: The folders of `packages` of the scenario.
    """
    inside = Path(name.removeprefix("package://").partition("/")[2]).parts
    if name.startswith("package://") and path.parts[-len(inside) :] == inside:
        given = (*given, path.parents[len(inside) - 1])
    return PackagePath.of_file(path, given)


def refuse_unknown_arguments(args: Mapping[str, Any], paths: Sequence[Path]) -> None:
    """Refuse arguments that none of a robot's files declares; included files may declare them.

    Raises:
        SpecError: A file is not XML.
        RobotError: No file takes one of the arguments.
    """
    roots = {path: root for path in paths if args and is_xacro(root := read_xml(path))}
    if args and not roots:
        raise RobotOptionError("args", "only a xacro file takes arguments, and none is given")
    declared = {name for root in roots.values() for name in arguments_of(root)}
    includes = any(item.tag == "xacro:include" for root in roots.values() for item in root.walk())
    unknown = [key for key in args if key not in declared]
    if unknown and not includes:
        names = " and ".join(path.name for path in roots)
        raise RobotOptionError(
            "args",
            f"{names} takes no argument '{unknown[0]}'; "
            f"known are {', '.join(sorted(declared)) or 'none'}",
        )
