"""Writes triangles as a binary STL file."""

from __future__ import annotations

from harness.core.types import FloatArray

Triangles = FloatArray
"""Corners of triangles, shape (N, 3, 3) [m]."""


def stl_bytes(triangles: Triangles) -> bytes:
    """The content of a binary STL file; normals follow from the corners, counter-clockwise."""
    from trimesh import Trimesh
    from trimesh import triangles as corners
    from trimesh.exchange.stl import export_stl

    return export_stl(Trimesh(**corners.to_kwargs(triangles), process=False))
