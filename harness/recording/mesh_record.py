"""The triangles of a mesh file, which pictures of a saved run need."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.core.geometry import Rgba
from harness.core.types import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class MeshRecord:
    """Triangles of one colour of a mesh file that links or objects look like.

    Attributes:
        path: The path of the file, as `Shape.geometry` names it; it need not be there any more.
        scale: The scale of `Shape.geometry`; the vertices are scaled already.
        vertices: The vertices, shape (V, 3) [m].
        faces: Indices of vertices, shape (F, 3).
        rgba: None where the file gives no colour: the shape's.
    """

    path: Path
    scale: tuple[float, float, float]
    vertices: FloatArray
    faces: IntArray
    rgba: Rgba | None = None
