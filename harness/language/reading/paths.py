"""Relative paths in a file, written as from another folder."""

from __future__ import annotations

import os
from pathlib import Path

from harness.language.files.source import Entry, Located

ROBOT_FILES = ("urdf", "xacro", "mjcf", "sdf", "srdf", "kinematics")
FOLDER_LISTS = ("packages", "model_path")
WORLD_FILES = (".yaml", ".yml", ".sdf", ".world", ".xml")


def paths_from(root: Located, old: Path, new: Path) -> Located:
    """The tree with its relative paths written as from another folder."""

    def moved(item: Located) -> Located:
        is_path = isinstance(item.value, str) and not Path(item.value).is_absolute()
        if not is_path or str(item.value).startswith("~") or "://" in str(item.value):
            return item
        return Located(os.path.relpath(old / str(item.value), new), item.place)

    def walk(item: Located, above: str) -> Located:
        if isinstance(item.value, list):
            return Located([walk(child, above) for child in item.value], item.place)
        if not isinstance(item.value, dict):
            return item
        entries: dict[str, Entry] = {}
        for key, (place, child) in item.value.items():
            is_file = key == "file" and above == "mesh"
            is_robots = above == "robot" and (key in ROBOT_FILES or _is_folder(key, child))
            is_robots = is_robots or (above == "moveit" and isinstance(child.value, str))
            is_world = _is_world_file(child) and (
                (item is root and key == "world") or (above == "world" and key == "name")
            )
            if key in FOLDER_LISTS and above in ("robot", "world"):
                child = Located([moved(folder) for folder in child.items()], child.place)
            is_moved = is_file or is_robots or is_world
            entries[key] = Entry(place, moved(child) if is_moved else walk(child, key))
        return Located(entries, item.place)

    robot = root.mapping().get("robot")
    if robot is not None and isinstance(robot.value.value, str) and "/" in robot.value.value:
        entries = {**root.mapping(), "robot": Entry(robot.key, moved(robot.value))}
        root = Located(entries, root.place)
    return walk(root, "")


def _is_folder(key: str, item: Located) -> bool:
    is_part = key in ("model", "gripper")
    return is_part and isinstance(item.value, str) and "/" in item.value


def _is_world_file(item: Located) -> bool:
    return isinstance(item.value, str) and Path(item.value).suffix.lower() in WORLD_FILES
