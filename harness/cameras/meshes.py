"""Mesh files as coloured triangles, coarse enough to draw quickly without a graphics card."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from harness.core.geometry import Mesh, Rgba
from harness.core.types import FloatArray, IntArray

GRID = 0.002
"""Vertices within a cell of this size become one [m]: about a pixel in a picture of an arm."""


@dataclass(frozen=True, eq=False)
class MeshPart:
    """Triangles of one colour.

    Attributes:
        vertices: Shape (V, 3) [m].
        faces: Shape (F, 3), indices of vertices.
        rgba: None where the file gives no colour.
    """

    vertices: FloatArray
    faces: IntArray
    rgba: Rgba | None


@lru_cache(maxsize=64)
def load_obj(geometry: Mesh) -> tuple[MeshPart, ...]:
    """Read a Wavefront OBJ file of triangles, one part a material.

    Polygons are read as fans. Diffuse colours of the MTL file are linear light, as Blender writes
    them, and come out as sRGB.
    """
    text = geometry.path.read_text(encoding="utf-8", errors="replace")
    vertices = np.array(
        " ".join(re.findall(r"^v (.*)$", text, re.MULTILINE)).split(), dtype=float
    ).reshape(-1, 3) * np.array(geometry.scale)
    colours = _read_mtl(geometry.path, text)
    parts: list[MeshPart] = []
    for name, section in _sections(text):
        faces = _faces(section, len(vertices))
        if len(faces):
            parts.append(MeshPart(*coarsen(vertices, faces), colours.get(name)))
    return tuple(part for part in parts if len(part.faces))


def coarsen(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Merge vertices that share a cell of the grid and drop triangles that collapse."""
    cells, inverse = np.unique(
        np.round(vertices / GRID).astype(np.int64), axis=0, return_inverse=True
    )
    inverse = inverse.reshape(-1)
    counts = np.bincount(inverse, minlength=len(cells))[:, None]
    merged = np.stack([np.bincount(inverse, vertices[:, i]) for i in range(3)], axis=1) / counts
    faces = inverse[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    used, faces = np.unique(faces, return_inverse=True)
    return merged[used], faces.reshape(-1, 3)


def _sections(text: str) -> list[tuple[str, str]]:
    """Faces by material: the text after each `usemtl`, or all of it."""
    pieces = re.split(r"^usemtl (.*)$", text, flags=re.MULTILINE)
    if len(pieces) == 1:
        return [("", text)]
    return list(zip(pieces[1::2], pieces[2::2], strict=True))


def _faces(section: str, count: int) -> IntArray:
    lines = re.findall(r"^f (.*)$", section, re.MULTILINE)
    corners = [len(line.split()) for line in lines[:1]]
    if corners == [3]:
        first = re.sub(r"/\S*", "", " ".join(lines)).split()
        if len(first) == 3 * len(lines):
            faces = np.array(first, dtype=np.int64).reshape(-1, 3)
            return np.where(faces < 0, faces + count, faces - 1)
    fans: list[tuple[int, int, int]] = []
    for line in lines:
        polygon = [int(corner.split("/")[0]) for corner in line.split()]
        polygon = [index + count if index < 0 else index - 1 for index in polygon]
        fans += [(polygon[0], b, c) for b, c in pairwise(polygon[1:])]
    return np.array(fans, dtype=np.int64).reshape(-1, 3)


def _read_mtl(path: Path, text: str) -> dict[str, Rgba]:
    library = re.search(r"^mtllib (.*)$", text, re.MULTILINE)
    file = path.parent / library.group(1).strip() if library else None
    if file is None or not file.is_file():
        return {}
    pattern = r"^newmtl (.*)$(?:(?!^newmtl)[\s\S])*?^Kd (\S+) (\S+) (\S+)"
    colours: dict[str, Rgba] = {}
    for name, *linear in re.findall(pattern, file.read_text(encoding="utf-8"), re.MULTILINE):
        red, green, blue = (min(1.0, float(value)) ** (1 / 2.2) for value in linear)
        colours[name] = (red, green, blue, 1.0)
    return colours
