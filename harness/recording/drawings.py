"""What is drawn of a run for people; no verdict reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.core.geometry import Rgba
from harness.core.types import FloatArray, IntArray
from harness.recording.signals import VideoRecord


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


@dataclass(frozen=True)
class Drawings:
    """What is drawn of a run for people.

    Attributes:
        meshes: The triangles of mesh files, for pictures where the files are not.
        videos: The videos of the cameras that were recorded all along.
        files: Content of the videos, and of pictures of the steps and of the states that explain
            failures, by path in the run's folder; a saved run reads each video on first use.
        note: A line on limitations of the pictures; empty without limitations.
    """

    meshes: tuple[MeshRecord, ...] = ()
    videos: tuple[VideoRecord, ...] = ()
    files: Mapping[str, bytes] = field(default_factory=dict[str, bytes], repr=False)
    note: str = ""


NO_DRAWINGS = Drawings()
