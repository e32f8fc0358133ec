"""Triangles of imported shapes, and their binary STL files."""

from __future__ import annotations

import math

import numpy as np

from harness.core.types import FloatArray

Triangles = FloatArray  # corners of triangles, shape (N, 3, 3) [m]
CONE_SIDES = 32  # sides of the pyramid that stands for a cone


def stl_bytes(triangles: Triangles) -> bytes:
    """The content of a binary STL file; normals follow from the corners, counter-clockwise."""
    from trimesh import Trimesh
    from trimesh import triangles as corners
    from trimesh.exchange.stl import export_stl

    return export_stl(Trimesh(**corners.to_kwargs(triangles), process=False))


def add_mesh(meshes: dict[str, Triangles], name: str, triangles: Triangles) -> str:
    """Add a mesh of an object to those that will be written; its file is named after the object."""
    safe = "".join(letter if letter.isalnum() else "_" for letter in name)[:60]
    file = f"{safe}_{len(meshes)}.stl"
    meshes[file] = triangles
    return file


def cone(radius: float, length: float) -> Triangles:
    """A cone about z, its tip up, the origin halfway between tip and base."""
    angles = np.linspace(0.0, 2 * math.pi, CONE_SIDES, endpoint=False)
    low = np.full(CONE_SIDES, -length / 2)
    rim = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), low])
    following = np.roll(rim, -1, axis=0)
    tip, middle = (np.broadcast_to([0, 0, z], rim.shape) for z in (length / 2, -length / 2))
    sides = np.stack([rim, following, tip], axis=1)
    return np.concatenate([sides, np.stack([following, rim, middle], axis=1)])
