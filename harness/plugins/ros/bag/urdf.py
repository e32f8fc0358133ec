"""The robot's URDF for other tools, and where they find its meshes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from harness.core.geometry import Mesh
from harness.recording.run import Run

MeshAddresses = Literal["package", "file"]
MESH = re.compile(r'(<mesh\b[^>]*\bfilename=")package://([^"]*)(")')


def urdf_of(run: Run, meshes: MeshAddresses = "package") -> str:
    """The composed URDF.

    Args:
        meshes: `package` leaves mesh addresses as the robot's source gave them; `file` makes those
            of `package://` absolute `file://` addresses on this machine, where they are known.
    """
    if meshes == "package":
        return run.robot.urdf
    known = {path.as_posix(): path for path in _mesh_paths(run)}

    def absolute(match: re.Match[str]) -> str:
        for posix, path in known.items():
            if posix.endswith(f"/{match[2]}"):
                return f"{match[1]}{path.absolute().as_uri()}{match[3]}"
        return match[0]

    return MESH.sub(absolute, run.robot.urdf)


def _mesh_paths(run: Run) -> Iterator[Path]:
    for shapes in run.robot.link_visuals.values():
        for shape in shapes:
            if isinstance(shape.geometry, Mesh):
                yield shape.geometry.path
