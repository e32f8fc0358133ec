"""Triangle meshes as 16-bit fractions of their bounds."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.recording.run import MeshRecord
from harness.reporting.html.packing import Packer, differences, zigzag

SMALLEST = 1e-9
STEPS = 65535


def pack_mesh(mesh: MeshRecord, number: int, packer: Packer) -> dict[str, Any]:
    """Put a mesh into the page's data, vertices in the order in which faces use them."""
    used, first, faces = np.unique(mesh.faces.ravel(), return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(used), dtype=np.int64)
    rank[order] = np.arange(len(used))
    vertices = mesh.vertices[used[order]]
    low = vertices.min(axis=0) if len(vertices) else np.zeros(3)
    size = np.ptp(vertices, axis=0) if len(vertices) else np.zeros(3)
    stored = np.rint((vertices - low) / np.maximum(size, SMALLEST) * STEPS)
    indices = zigzag(rank[faces.ravel()])
    return {
        "vertices": packer.add(f"mesh.{number}.vertices", differences(stored.T)),
        "faces": packer.add(f"mesh.{number}.faces", indices),
        "wide": bool(indices.dtype == np.uint32),
        "low": low.tolist(),
        "size": size.tolist(),
    }
