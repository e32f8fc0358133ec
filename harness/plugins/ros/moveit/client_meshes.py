"""Meshes that clients send, as files that planner and report read."""

from __future__ import annotations

import hashlib
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from harness.core.errors import StepFailed
from harness.core.geometry import CollisionMode, Mesh
from harness.core.types import FloatArray, IntArray
from harness.core.user_cache import cache_folder

SIDES = 32
"""Sides of the pyramid that stands for a cone, which is wider by at most 0.5 % of the radius."""

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def client_mesh(corners: FloatArray, triangles: IntArray, mode: CollisionMode = "exact") -> Mesh:
    """A mesh with a file in the user's cache, named after its content.

    Args:
        corners: The corners [m], shape (N, 3).
        triangles: The indices of corners, shape (M, 3).
        mode: How the mesh collides in the planner.

    Raises:
        StepFailed: The file cannot be written.
    """
    facets = np.zeros(len(triangles), _FACET)
    facets["corners"] = corners[triangles]
    content = bytes(80) + np.uint32(len(facets)).tobytes() + facets.tobytes()
    path = cache_folder() / "client_meshes" / f"{hashlib.sha256(content).hexdigest()[:32]}.stl"
    try:
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
                file.write(content)
            Path(file.name).replace(path)
    except OSError as error:
        reason = f"a mesh cannot be stored in {path.parent}: {error.strerror}"
        raise StepFailed("FAILURE", reason) from error
    return Mesh(path, collision=mode)


@cache
def cone_mesh(height: float, radius: float) -> Mesh:
    """A cone about the local z axis, its tip up and its middle at the origin, as a pyramid.

    Args:
        height: The height from the base to the tip [m].
        radius: The radius of the base [m], which the pyramid encloses.
    """
    turns = np.arange(SIDES) * (2 * np.pi / SIDES)
    wide = radius / np.cos(np.pi / SIDES)
    rim = np.column_stack([wide * np.cos(turns), wide * np.sin(turns), np.zeros(SIDES)])
    corners = np.vstack([rim, [0, 0, 0], [0, 0, height]]) - [0, 0, height / 2]
    here = np.arange(SIDES)
    after, base, tip = (here + 1) % SIDES, np.full(SIDES, SIDES), np.full(SIDES, SIDES + 1)
    sides = np.column_stack([here, after, tip]), np.column_stack([after, here, base])
    return client_mesh(corners, np.vstack(sides), "hull")
