"""Mesh files as coloured triangles for pictures and pages."""

from __future__ import annotations

from functools import lru_cache

from harness.cameras.collada_parts import load_collada
from harness.cameras.mesh_part import MeshPart, coarsen
from harness.cameras.obj_parts import load_obj
from harness.core.errors import RobotError
from harness.core.geometry import Mesh
from harness.robot.mesh_file import read_triangles


@lru_cache(maxsize=256)
def mesh_parts(geometry: Mesh) -> tuple[MeshPart, ...]:
    """The triangles of a mesh file, one part per colour; empty when it cannot be read."""
    try:
        match geometry.path.suffix.lower():
            case ".obj":
                return load_obj(geometry)
            case ".dae":
                return load_collada(geometry)
            case _:
                triangles = read_triangles(geometry)
                return (MeshPart(*coarsen(triangles.vertices, triangles.faces), None),)
    except (RobotError, OSError, ValueError):
        return ()
