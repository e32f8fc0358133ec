"""Writes a loaded scenario as a file of its own: parameters, overrides and seed applied."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from harness.spec.load import SDF_SUFFIXES, WORLD_SUFFIXES, LoadedScenario
from harness.spec.params import PARAMS, escaped
from harness.spec.scenario import Scenario
from harness.spec.short_forms import models_shape
from harness.spec.source import Entry, Loc, Located, Source, SourceMap
from harness.spec.yaml_file import parse_yaml
from harness.spec.yaml_text import yaml_text

ROBOT_FILES = ("urdf", "xacro", "mjcf", "srdf", "kinematics")
FOLDER_LISTS = ("packages", "model_path")
BLOCK_KEYS = ("steps", "during", "expect")
"""Keys whose lists begin a line for each item, so that a step can be found by its line."""


def resolved_text(
    loaded: LoadedScenario,
    step_seeds: Mapping[Loc, int] | None = None,
    *,
    folder: Path | None = None,
) -> str:
    """The scenario as YAML in the file's own short forms; loads to an equal scenario.

    Args:
        loaded: The scenario.
        step_seeds: Path of a step in the model -> its seed, written above it as a comment.
        folder: Where the text will be saved; relative paths are written as from there (only
            then do they, alone, differ from the file's).
    """
    entries = {
        key: entry if key == PARAMS else Entry(entry.key, escaped(entry.value))
        for key, entry in loaded.written.mapping().items()
    }
    seed = Located(loaded.scenario.seed, loaded.written.place)
    entries["seed"] = Entry(seed.place, seed)
    root = Located(entries, loaded.written.place)
    if folder is not None:
        root = _paths_from(root, loaded.path.parent, folder)
    return _with_comments(yaml_text(root, block_keys=BLOCK_KEYS), step_seeds or {})


def _with_comments(text: str, seeds: Mapping[Loc, int]) -> str:
    if not seeds:
        return text
    source = Source.of_text("", text)
    lines = SourceMap(models_shape(parse_yaml(text, source), Scenario, []))
    comments: dict[int, list[str]] = {}
    for loc, seed in seeds.items():
        number, _ = lines.line_of(loc)
        comments.setdefault(number, []).append(f"# seed {seed}")
    written: list[str] = []
    for number, line in enumerate(text.splitlines(), start=1):
        indent = " " * (len(line) - len(line.lstrip(" ")))
        written += [indent + comment for comment in comments.get(number, [])]
        written.append(line)
    return "\n".join(written) + "\n"


def _paths_from(root: Located, old: Path, new: Path) -> Located:
    """The tree with its relative paths written as from another folder."""

    def moved(item: Located) -> Located:
        is_path = isinstance(item.value, str) and not Path(item.value).is_absolute()
        if not is_path or str(item.value).startswith("~"):
            return item
        return Located(os.path.relpath(old / str(item.value), new), item.place)

    def walk(item: Located, above: str) -> Located:
        if isinstance(item.value, list):
            return Located([walk(child, above) for child in item.value], item.place)
        if not isinstance(item.value, dict):
            return item
        entries: dict[str, Entry] = {}
        for key, (place, child) in item.value.items():
            is_file = key == "file" and above in ("mesh", "include")
            is_robots = above == "robot" and (key in ROBOT_FILES or _is_folder(key, child))
            is_include = key == "include" and isinstance(child.value, str)
            is_world = _is_world_file(child) and (
                (item is root and key == "world") or (above == "world" and key == "name")
            )
            if key in FOLDER_LISTS and above in ("robot", "world"):
                child = Located([moved(folder) for folder in child.items()], child.place)
            is_moved = is_file or is_robots or is_include or is_world
            entries[key] = Entry(place, moved(child) if is_moved else walk(child, key))
        return Located(entries, item.place)

    robot = root.mapping().get("robot")
    if robot is not None and isinstance(robot.value.value, str) and "/" in robot.value.value:
        entries = {**root.mapping(), "robot": Entry(robot.key, moved(robot.value))}
        root = Located(entries, root.place)
    return walk(root, "")


def _is_folder(key: str, item: Located) -> bool:
    return key in ("model", "ur_type", "gripper") and "/" in str(item.value)


def _is_world_file(item: Located) -> bool:
    return Path(str(item.value)).suffix.lower() in (*WORLD_SUFFIXES, *SDF_SUFFIXES)
