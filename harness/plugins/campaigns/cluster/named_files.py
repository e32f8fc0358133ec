"""The files that a scenario names, for a machine that does not have them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from harness.core.files import is_file

MESHES = (".stl", ".obj", ".dae", ".ply", ".glb")
INPUTS = (".yaml", ".yml", ".sdf", ".world", ".urdf", ".xacro", ".srdf", ".xml", *MESHES)
"""Endings of files that are sent where a scenario, or a file that it names, names them."""

_NAME = re.compile(r"""\"([^\"\n]+)\"|'([^'\n]+)'|([^\s\"',\[\]{}<>=]+)""")


def named_files(file: Path) -> Iterator[tuple[Path, bytes]]:
    """A scenario file and the files that it names, and those that they name, with their contents.

    A name is any word or quoted text with the ending of an input, from the folder of the file that
    says it, and in YAML one of a folder with a robot.yaml: to read one too many does no harm. What
    packages hold is not followed.
    """
    waiting, seen = [file], set[Path]()
    while waiting:
        path = waiting.pop()
        if path in seen or not is_file(path):
            continue
        seen.add(path)
        try:
            data = path.read_bytes()
        except OSError:
            continue
        yield path, data
        if path.suffix.lower() not in MESHES:
            text = data.decode("utf-8", "replace")
            names = sorted({"".join(groups) for groups in _NAME.findall(text)})
            waiting += [path.parent / name for name in names if name.lower().endswith(INPUTS)]
            if path.suffix.lower() in (".yaml", ".yml"):
                waiting += [path.parent / name / "robot.yaml" for name in names]
