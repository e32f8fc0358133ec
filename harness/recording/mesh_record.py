"""The triangles of a mesh file, which pictures of a saved run need."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.core.geometry import Rgba
from harness.core.types import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class MeshRecord:
    """Triangles of one colour of a mesh file that links or objects look like.

    Attributes:
        path: The path of the file, as `Shape.geometry` names it; it need not be there any more.
        scale: The scale of `Shape.geometry`; the vertices are scaled already.
        vertices: The vertices, shape (V, 3) [m]; run.json has none, but visuals.npz.
        faces: Indices of vertices, shape (F, 3); likewise.
        rgba: None where the file gives no colour: the shape's.
    """

    path: Path
    scale: tuple[float, float, float]
    vertices: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    faces: IntArray = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    rgba: Rgba | None = None
