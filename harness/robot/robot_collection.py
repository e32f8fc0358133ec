"""Folders of robots that packages provide, as plug-ins."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import ClassVar

from harness.core.registry import Plugin, PluginError, registry
from harness.robot.robot_yaml import RobotYaml, read_robot_yaml

__all__ = ["RobotCollection"]
"""What a package needs to add robots of its own."""


class RobotCollection(Plugin):
    """A folder with a folder for each robot or gripper, as robots/ of this program."""

    plugin_kind: ClassVar[str] = "robot"
    folder: ClassVar[Path]


@cache
def collected_robots() -> dict[str, tuple[Path, RobotYaml]]:
    """Every model name of the installed collections, with its folder and robot.yaml.

    Raises:
        PluginError: A collection has no folder, or two collections provide one name.
        SpecError: A robot.yaml has mistakes.
    """
    models: dict[str, tuple[Path, RobotYaml]] = {}
    collections = registry(RobotCollection.plugin_kind)
    for word, collection in collections.items():
        folder = getattr(collection, "folder", None)
        package = collections.package_of(word)
        if not isinstance(folder, Path) or not folder.is_dir():
            raise PluginError(package, f"the robot collection `{word}` has no `folder`: {folder}")
        for path in sorted(folder.glob("*/robot.yaml")):
            facts = read_robot_yaml(path.parent)
            for name in facts.variants or (facts.robot,):
                if name in models:
                    raise PluginError(package, f"the robot `{name}` is provided twice")
                models[name] = (path.parent, facts)
    return models


@cache
def package_of_robot(name: str) -> str:
    """The package that provides a robot of a collection."""
    collections = registry(RobotCollection.plugin_kind)
    folder, _ = collected_robots()[name]
    return next(
        collections.package_of(word)
        for word, collection in collections.items()
        if folder.is_relative_to(collection.folder)
    )
