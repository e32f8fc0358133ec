"""Writes triangles as a binary STL file."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray

Triangles = FloatArray
"""Corners of triangles, shape (N, 3, 3) [m]."""

ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl_bytes(triangles: Triangles) -> bytes:
    """The content of a binary STL file; normals follow from the corners, counter-clockwise."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.zeros(len(triangles), dtype=ROW)
    rows["normal"] = normals / np.where(lengths > 0, lengths, 1.0)
    rows["corners"] = triangles
    return bytes(80) + np.uint32(len(triangles)).tobytes() + rows.tobytes()
