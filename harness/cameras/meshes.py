"""Mesh files as coloured triangles for pictures and pages."""

from __future__ import annotations

import hashlib
import io
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.errors import MissingPackage, RobotError
from harness.core.extras import missing_extra
from harness.core.geometry import Mesh, Rgba
from harness.core.inputs import read_input
from harness.core.limits import READING_MEMORY
from harness.core.memory import limited_memory
from harness.core.types import FloatArray, IntArray
from harness.core.user_cache import cached, store
from harness.core.world import WorldObject
from harness.language.base import LARGEST_NUMBER
from harness.language.files.yaml_file import read_text
from harness.robot.collada import refuse_unreadable
from harness.robot.description import RobotDescription
from harness.robot.mesh_file import metres_per_unit, read_triangles

GRID = 0.002  # [m], of the cells in which vertices merge: about a pixel in a picture of an arm
LARGE = 2**16  # [bytes], of OBJ files whose parts are kept


@dataclass(frozen=True, eq=False)
class MeshPart:
    """Triangles of one colour.

    Attributes:
        vertices: The vertices, shape (V, 3) [m].
        faces: The faces as indices of vertices, shape (F, 3).
        rgba: None where the file gives no colour.
    """

    vertices: FloatArray
    faces: IntArray
    rgba: Rgba | None


def coarsen(
    vertices: FloatArray, faces: IntArray, grid: float = GRID
) -> tuple[FloatArray, IntArray]:
    """Merge vertices that share a cell of a grid [m] and drop triangles that collapse.

    Raises:
        ValueError: A vertex is not finite, or too far away.
    """
    if not np.abs(vertices).max(initial=0.0) <= LARGEST_NUMBER:
        raise ValueError("a vertex is not finite or too far away")
    cells = np.round(vertices / grid).astype(np.int64)
    cells -= cells.min(axis=0, initial=0)
    numbers = np.ravel_multi_index((*cells.T,), (*(cells.max(axis=0, initial=0) + 1),))
    inverse = np.unique(numbers, return_inverse=True)[1]
    counts = np.bincount(inverse)[:, None]
    merged = np.stack([np.bincount(inverse, vertices[:, i]) for i in range(3)], axis=1) / counts
    faces = inverse[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    used, faces = np.unique(faces, return_inverse=True)
    return merged[used], faces.reshape(-1, 3)


def load_obj(geometry: Mesh) -> tuple[MeshPart, ...]:
    """Read a Wavefront OBJ file of triangles, one part per material.

    Polygons are split into fans. Diffuse colours of the MTL file are linear, as Blender writes
    them, and are converted to sRGB. The parts of a large file are kept in the user's cache
    directory: reading a robot's files takes a quarter of a second.
    """
    content = read_input(geometry.path)
    materials = _material_file(geometry.path, content)
    if len(content) < LARGE:
        return _read_obj(content, materials, geometry)
    others = repr((len(content), materials, geometry.scale)).encode()
    key = hashlib.sha256(content + others + Path(__file__).read_bytes())
    name = f"meshes/{key.hexdigest()}.npz"
    stored = cached(name)
    if stored is None:
        parts = _read_obj(content, materials, geometry)
        store(name, _packed(parts))
        return parts
    return _unpacked(stored)


def _packed(parts: Sequence[MeshPart]) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, *(x for part in parts for x in (part.vertices, part.faces, part.rgba or ())))
    return stream.getvalue()


def _unpacked(stored: bytes) -> tuple[MeshPart, ...]:
    with np.load(io.BytesIO(stored)) as arrays:
        parts = [arrays[f"arr_{number}"] for number in range(len(arrays.files))]
    return tuple(
        MeshPart(vertices, faces, tuple(rgba.tolist()) or None)
        for vertices, faces, rgba in zip(parts[::3], parts[1::3], parts[2::3], strict=True)
    )


def _read_obj(content: bytes, materials: str, geometry: Mesh) -> tuple[MeshPart, ...]:
    text = content.decode("utf-8", errors="replace")
    rows = re.findall(r"^v[ \t]+(\S+[ \t]+\S+[ \t]+\S+)", text, re.MULTILINE)  # colours may follow
    vertices = np.fromstring(" ".join(rows), sep=" ").reshape(len(rows), 3)
    vertices *= np.array(geometry.scale)
    colours = _colours(materials)
    parts: list[MeshPart] = []
    for name, section in _sections(text):
        faces = _faces(section, len(vertices))
        if len(faces):
            parts.append(MeshPart(*coarsen(vertices, faces), colours.get(name)))
    return tuple(part for part in parts if len(part.faces))


def _sections(text: str) -> list[tuple[str, str]]:
    """Faces by material: the text before the first `usemtl`, and after each."""
    pieces = re.split(r"^usemtl (.*)$", text, flags=re.MULTILINE)
    return list(zip(["", *pieces[1::2]], pieces[::2], strict=True))


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


def _material_file(path: Path, content: bytes) -> str:
    """The MTL file of an OBJ file; empty where there is none."""
    library = re.search(rb"^mtllib (.*)$", content, re.MULTILINE)
    if library is None:
        return ""
    file = (path.parent / library.group(1).decode("utf-8", errors="replace").strip()).resolve()
    is_next_to_it = file.is_relative_to(path.parent.resolve()) and file.is_file()
    return read_text(file, kind="MTL file") if is_next_to_it else ""


def _colours(materials: str) -> dict[str, Rgba]:
    pattern = r"^newmtl (.*)$(?:(?!^newmtl)[\s\S])*?^Kd (\S+) (\S+) (\S+)"
    colours: dict[str, Rgba] = {}
    for name, *linear in re.findall(pattern, materials, re.MULTILINE):
        red, green, blue = (min(1.0, float(value)) ** (1 / 2.2) for value in linear)
        colours[name] = (red, green, blue, 1.0)
    return colours


@lru_cache(maxsize=256)
def mesh_parts(geometry: Mesh) -> tuple[MeshPart, ...]:
    """The triangles of a mesh file, one part per colour; empty when it cannot be read."""
    try:
        metres_per_unit(geometry)  # refuses what is too large
        with limited_memory(READING_MEMORY):
            match geometry.path.suffix.lower():
                case ".obj":
                    return load_obj(geometry)
                case ".dae":
                    return load_collada(geometry)
                case _:
                    triangles = read_triangles(geometry)
                    return (MeshPart(*coarsen(triangles.vertices, triangles.faces), None),)
    except MissingPackage:
        raise
    except (RobotError, OSError, ValueError, IndexError, MemoryError):
        return ()


def undrawn(description: RobotDescription, objects: Sequence[WorldObject]) -> tuple[str, ...]:
    """Names of mesh files that cannot be drawn, sorted."""
    looks = [link.visuals for link in description.links]
    looks += [obj.visuals or obj.shapes for obj in objects]
    shapes = [shape.geometry for look in looks for shape in look]
    meshes = [geometry for geometry in shapes if isinstance(geometry, Mesh)]
    return tuple(sorted({mesh.path.name for mesh in meshes if not mesh_parts(mesh)}))


def load_collada(geometry: Mesh) -> tuple[MeshPart, ...]:
    """The triangles of a file's scene, one part per colour.

    As in the collision geometry of the same file, its `unit` is applied and its `up_axis` is not.

    Raises:
        RobotError: The file is too large or damaged, or its scene has no triangles.
        MissingPackage: The extra `meshes` is not installed.
    """
    try:
        import collada  # here: few robots have COLLADA files
        import collada.common
    except ModuleNotFoundError as error:
        name = geometry.path.name
        raise MissingPackage(f"{name} cannot be read: {missing_extra(error)}") from error

    scale = metres_per_unit(geometry) * np.array(geometry.scale)
    refuse_unreadable(geometry.path.read_bytes(), geometry.path.name)
    unknown = [collada.common.DaeUnsupportedError, collada.common.DaeBrokenRefError]
    try:
        with warnings.catch_warnings():  # the library uses numpy.matrix, and sets shapes of arrays
            warnings.simplefilter("ignore")
            scene = collada.Collada(str(geometry.path), ignore=unknown).scene
            pieces = _pieces(scene, scale) if scene else {}
    except (collada.common.DaeError, AttributeError, ValueError, IndexError) as error:
        raise RobotError(f"{geometry.path.name} cannot be read: it is damaged") from error
    if not pieces:
        raise RobotError(f"{geometry.path.name} has a scene without triangles")
    return tuple(MeshPart(*coarsen(*_joined(found)), rgba) for rgba, found in pieces.items())


def _pieces(
    scene: Any, scale: np.ndarray
) -> dict[Rgba | None, list[tuple[np.ndarray, np.ndarray]]]:
    """Vertices [m] and faces of every primitive that has triangles, by colour."""
    pieces: dict[Rgba | None, list[tuple[np.ndarray, np.ndarray]]] = {}
    for shown in scene.objects("geometry"):
        for primitive in shown.primitives():
            polygons = hasattr(primitive, "triangleset")
            triangles = primitive.triangleset() if polygons else primitive
            corners = np.asarray(getattr(triangles, "vertex_index", ()))
            if corners.size and corners.ndim == 2 and corners.shape[1] == 3:  # lines have two
                colour = _diffuse(triangles.material)
                pieces.setdefault(colour, []).append((triangles.vertex * scale, corners))
    return pieces


def _joined(pieces: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    vertices = np.concatenate([vertices for vertices, _ in pieces])
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    faces = [faces + start for (_, faces), start in zip(pieces, starts, strict=False)]
    return vertices, np.concatenate(faces).astype(np.int64)


def _diffuse(material: Any) -> Rgba | None:
    """The material's colour; None for a texture or no colour."""
    colour = getattr(getattr(material, "effect", None), "diffuse", None)
    if not isinstance(colour, tuple) or len(colour) < 3:
        return None
    red, green, blue = (float(min(1.0, max(0.0, value))) for value in colour[:3])
    return red, green, blue, 1.0
