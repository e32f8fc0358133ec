"""Cuts meshes into convex parts."""

from __future__ import annotations

from typing import ClassVar

from harness.core.types import FloatArray
from harness.robot.convex_parts import Decomposer, Decomposition


class Cuts(Decomposer):
    """Cut a mesh with planes until each part is nearly convex."""

    name: ClassVar[str] = "cuts"
    version: ClassVar[int] = 5

    def decompose(self, triangles: FloatArray, *, is_hull: bool) -> Decomposition:
        """Cut a mesh into convex parts, or take its hull."""
        from harness.plugins.meshes.decomposition import decompose  # here: imports SciPy

        return decompose(triangles, is_hull=is_hull)
