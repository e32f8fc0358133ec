"""Wavefront OBJ files as coloured triangles."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np

from harness.cameras.mesh_part import MeshPart, coarsen
from harness.core.geometry import Mesh, Rgba
from harness.core.types import IntArray


def load_obj(geometry: Mesh) -> tuple[MeshPart, ...]:
    """Read a Wavefront OBJ file of triangles, one part per material.

    Polygons are split into fans. Diffuse colours of the MTL file are linear, as Blender writes
    them, and are converted to sRGB.
    """
    text = geometry.path.read_text(encoding="utf-8", errors="replace")
    lines = " ".join(re.findall(r"^v (.*)$", text, re.MULTILINE))
    vertices = np.fromstring(lines, sep=" ").reshape(-1, 3) * np.array(geometry.scale)
    colours = _read_mtl(geometry.path, text)
    parts: list[MeshPart] = []
    for name, section in _sections(text):
        faces = _faces(section, len(vertices))
        if len(faces):
            parts.append(MeshPart(*coarsen(vertices, faces), colours.get(name)))
    return tuple(part for part in parts if len(part.faces))


def _sections(text: str) -> list[tuple[str, str]]:
    """Faces by material: the text after each `usemtl`, or the whole text."""
    pieces = re.split(r"^usemtl (.*)$", text, flags=re.MULTILINE)
    if len(pieces) == 1:
        return [("", text)]
    return list(zip(pieces[1::2], pieces[2::2], strict=True))


def _faces(section: str, count: int) -> IntArray:
    lines = re.findall(r"^f (.*)$", section, re.MULTILINE)
    corners = [len(line.split()) for line in lines[:1]]
    if corners == [3]:
        first = np.fromstring(re.sub(r"/\S*", "", " ".join(lines)), dtype=np.int64, sep=" ")
        if len(first) == 3 * len(lines):
            faces = first.reshape(-1, 3)
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
