"""Finds files and folders of a scenario's robot."""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence
from pathlib import Path

from harness.core.errors import RobotOptionError
from harness.core.files import expanded, is_dir, is_file
from harness.robot.packages import NotFoundError, PackagePath


def find_file(name: str, key: str, base_dir: Path, given: Sequence[Path]) -> Path:
    """A robot's file: a path from the scenario's folder, or package://name/path.

    Raises:
        RobotError: It does not exist.
    """
    if name.startswith("package://"):
        packages = PackagePath.of_file(base_dir / "scenario", given)
        try:
            path = packages.file(name, base_dir)
        except NotFoundError as error:
            raise RobotOptionError(key, str(error)) from error
        for package in packages.assumed:  # a guess is for files of others, not for the scenario
            raise RobotOptionError(
                key, f"the package '{package}' is not found; without a package it would be {path}"
            )
        return path
    path = base_dir / expanded(name)
    if not is_file(path):
        if os.path.lexists(path):  # a folder, a pipe, or links in a circle
            raise RobotOptionError(key, f"{path} is no file that can be read")
        near = difflib.get_close_matches(path.name, _names(path.parent), 1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise RobotOptionError(key, f"there is no file {path}{hint}")
    return path


def _names(folder: Path) -> list[str]:
    return sorted(each.name for each in folder.iterdir()) if is_dir(folder) else []


def find_folder(name: str, base_dir: Path) -> Path:
    """A folder of `packages`.

    Raises:
        RobotError: It does not exist.
    """
    folder = base_dir / expanded(name)
    if not is_dir(folder):
        raise RobotOptionError("packages", f"there is no folder {folder}")
    return folder
