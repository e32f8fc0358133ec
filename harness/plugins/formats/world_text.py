"""Writes a world as the text of a world file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from harness.language.files.source import Place, Source, located
from harness.language.files.yaml_text import yaml_text
from harness.language.world import WorldSpec
from harness.plugins.formats.sdf.round_meshes import FOLDER


def world_text(world: WorldSpec, folder: Path, comment: str = "") -> str:
    """YAML that loads to an equal world.

    Args:
        folder: Folder of the file; paths of mesh files are relative to it. Those of this package
            are to be copied there.
    """
    plain = world.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    moved = _from_folder(plain, folder)
    text = yaml_text(located(moved, Place(Source(""))), block_keys=("objects", "shapes", "visuals"))
    lines = [f"# {line}\n" for line in comment.splitlines()]
    return "".join(lines) + text


def _from_folder(value: Any, folder: Path, key: str = "") -> Any:
    """The data with mesh files as paths relative to a folder."""
    if isinstance(value, list):
        return [_from_folder(item, folder) for item in cast("list[Any]", value)]
    if not isinstance(value, Mapping):
        return value
    entries = cast("Mapping[str, Any]", value)
    if key == "mesh" and Path(entries["file"]).parent == FOLDER:
        return {**entries, "file": Path(entries["file"]).name}
    if key == "mesh" and Path(entries["file"]).is_absolute():
        return {**entries, "file": os.path.relpath(entries["file"], folder.resolve())}
    return {name: _from_folder(item, folder, name) for name, item in entries.items()}
