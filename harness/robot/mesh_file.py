"""Mesh files as triangles, convex hulls and parts, for planner and physics alike.

As in MoveIt and RViz, a COLLADA file's `unit` is applied and its `up_axis` is not; nor is a GLB
file turned, whose second axis points up by convention.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from harness.core.errors import MissingPackage, RobotError
from harness.core.extras import absent_package, missing_extra
from harness.core.files import open_regular
from harness.core.geometry import Hull, Mesh, Shape
from harness.core.inputs import read_input
from harness.core.limits import MESH_FILE, READING_MEMORY
from harness.core.memory import limited_memory
from harness.core.solids import solid_of
from harness.core.types import FloatArray, IntArray
from harness.language.base import LARGEST_NUMBER, SMALLEST_SIZE
from harness.robot.collada import HEADER, metres_of_unit, refuse_unreadable
from harness.robot.convex_parts import Decomposition, stored_decomposition

SUFFIXES = (".stl", ".obj", ".dae", ".ply", ".glb")
KINDS = "STL, OBJ, DAE, PLY or GLB"

FLAT = 1e-6
"""Thickness below which a mesh is flat, as a share of its extent: coordinates in single precision
are rounded to a tenth of that. Qhull crashes on points within 1e-8."""


@dataclass(frozen=True, eq=False)
class Triangles:
    """A mesh.

    Attributes:
        vertices: Vertices, shape (N, 3) [m].
        faces: Indices of vertices, shape (M, 3).
    """

    vertices: FloatArray
    faces: IntArray


def require_reader(geometry: Mesh) -> None:
    """Check that the package which reads a mesh file is installed.

    Raises:
        MissingPackage: It is not.
    """
    package = {".dae": "collada", ".obj": ""}.get(geometry.path.suffix.lower(), "trimesh")
    if package and (missing := absent_package(package)):
        raise MissingPackage(f"{geometry.path.name} cannot be read: {missing}")


@lru_cache(maxsize=128)
def read_triangles(geometry: Mesh) -> Triangles:
    """All triangles of a file.

    Raises:
        RobotError: The file is of an unsupported kind, too large, or damaged.
        MissingPackage: The extra `meshes` is not installed.
    """
    path = geometry.path
    scale = np.array(geometry.scale, dtype=float) * metres_per_unit(geometry)
    kind = path.suffix[1:].lower()
    content = read_input(path)
    if kind == "dae":
        refuse_unreadable(content, path.name)
    try:
        with limited_memory(READING_MEMORY):
            vertices, faces = _read(content, kind)
            vertices = vertices * scale
            corners = vertices[faces]
    except ModuleNotFoundError as error:
        raise MissingPackage(f"{path.name} cannot be read: {missing_extra(error)}") from error
    except MemoryError as error:
        most = f"{READING_MEMORY / 1e9:g} GB"
        raise RobotError(f"{path.name} takes more than {most} to read") from error
    except Exception as error:  # every format's reader has errors of its own
        raise RobotError(
            f"{path.name} cannot be read: it is damaged or not in {kind.upper()} format"
        ) from error
    if not len(faces):
        raise RobotError(
            f"{path.name} has no triangles: it is empty, damaged or not in {kind.upper()} format"
        )
    if not np.isfinite(corners).all():
        raise RobotError(f"{path.name} has corners that are not finite numbers: it is damaged")
    if np.abs(corners).max() > LARGEST_NUMBER:
        raise RobotError(f"{path.name} has corners farther away than {LARGEST_NUMBER:g} m")
    return Triangles(vertices, faces)


def _read(content: bytes, kind: str) -> tuple[FloatArray, IntArray]:
    """Vertices in the file's unit and triangles.

    Raises:
        Exception: Of the reader of its format, where the file is damaged.
    """
    import trimesh  # here: most robots are loaded without reading their meshes

    logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # not the tracebacks of damaged files
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # As a stream, so that the file cannot name others, such as textures.
        stream = io.BytesIO(content)
        scene = trimesh.load_scene(stream, file_type=kind, process=False, skip_materials=True)
        mesh = scene.to_mesh()
        if kind == "stl" and not _is_whole_stl(content, len(mesh.faces)):
            raise ValueError("some facets have not three corners")
        if len(mesh.faces) and mesh.faces.min() < 0:
            raise ValueError("a corner does not exist")  # NumPy would count it from the end
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
    return np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)


def _is_whole_stl(content: bytes, count: int) -> bool:
    """Whether a reader found all facets of an STL file; those of a binary one it counts itself."""
    if len(content) == 84 + 50 * int.from_bytes(content[80:84], "little"):
        return True
    lines = [line for line in content.lower().splitlines() if b"solid" not in line]
    words = b"\n".join(lines).split()
    facets = words.count(b"facet"), words.count(b"endfacet")
    return facets == (count, count) and words.count(b"vertex") == 3 * count


@lru_cache(maxsize=128)
def exact_surface(geometry: Mesh) -> Any:
    """All triangles of a file as Coal's geometry, a surface.

    Raises:
        RobotError: As `read_triangles`.
    """
    import coal

    mesh = read_triangles(geometry)
    corners, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    corners.extend(list(mesh.vertices))
    faces.extend([coal.Triangle(*face) for face in mesh.faces.tolist()])
    surface = coal.BVHModelOBBRSS()
    surface.beginModel(len(faces), len(corners))
    surface.addSubModel(corners, faces)
    surface.endModel()
    return surface


@lru_cache(maxsize=512)
def convex_hull(geometry: Mesh) -> Any:
    """The convex hull of a file's points, or of a part of the mesh, as Coal's geometry, a solid.

    Raises:
        RobotError: As `read_triangles`; or the mesh is flat, or Qhull fails.
    """
    found = decomposition_of(geometry)
    points = found.hull if geometry.part is None else found.parts[geometry.part]
    with _hull_errors(geometry):
        return hull_of(points)


@contextmanager
def _hull_errors(geometry: Mesh) -> Iterator[None]:
    """Names the mesh where Qhull fails."""
    try:
        yield
    except (RuntimeError, ValueError) as error:
        reason = str(error).splitlines()[-1]
        raise RobotError(f"{geometry.path.name} has no convex hull: {reason}") from error


def is_flat(points: FloatArray) -> bool:
    """Whether points are in a plane, or all in one place, within `FLAT` of their extent."""
    away = points - points.mean(axis=0)
    extent = float(np.ptp(away, axis=0).max())
    if extent < SMALLEST_SIZE:
        return True
    away = away / extent
    normal = np.linalg.eigh(away.T @ away)[1][:, 0]
    return float(np.ptp(away @ normal)) < FLAT


def hull_of(points: FloatArray) -> Any:
    """The convex hull of points as Coal's geometry.

    Raises:
        RuntimeError: The points are in a plane, or Qhull fails.
    """
    import coal

    if is_flat(points):  # Qhull can crash on such points
        raise RuntimeError("its points are in a plane")

    corners = coal.StdVec_Vec3s()
    corners.extend(list(points))
    try:
        return coal.Convex.convexHull(corners, True, "Qt")
    except RuntimeError:
        # A corner of Coal's hulls has at most 255 neighbours, and Qhull divides a disc of many
        # corners into triangles about one of them. Joggled input divides it otherwise.
        return coal.Convex.convexHull(corners, True, "QJ")


def decomposition_of(geometry: Mesh) -> Decomposition:
    """The convex parts of a mesh, from the cache where they are known.

    One that collides as its hull is not cut: the hull is its only part.

    Raises:
        RobotError: As `convex_hull`.
    """
    is_hull = geometry.collision == "hull"
    return _decomposition(Mesh(geometry.path, geometry.scale), is_hull=is_hull)


@lru_cache(maxsize=512)
def _decomposition(geometry: Mesh, *, is_hull: bool) -> Decomposition:
    def triangles() -> FloatArray:
        mesh = read_triangles(geometry)
        if is_flat(mesh.vertices):  # Qhull can crash on such points
            raise RobotError(f"{geometry.path.name} is flat: it encloses nothing to touch")
        return mesh.vertices[mesh.faces]

    factors = np.array(geometry.scale) * metres_per_unit(geometry)
    with _hull_errors(geometry):
        content = read_input(geometry.path)
        return stored_decomposition(content, factors, triangles, is_hull=is_hull)


def hull_points(geometry: Mesh) -> FloatArray:
    """Corners of the convex hull, shape (N, 3) [m]."""
    hull = convex_hull(geometry)
    return np.array(hull.points(), dtype=float).reshape(-1, 3)


def metres_per_unit(geometry: Mesh) -> float:
    """Metres of a COLLADA file's unit; 1 for other files, which are in metres.

    Raises:
        RobotError: The file is of an unsupported kind, too large, or not COLLADA.
    """
    path = geometry.path
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise RobotError(f"{path.name} is not a {KINDS} file")
    try:
        size = path.stat().st_size
        with open_regular(path) as file:
            header = file.read(HEADER)
    except OSError as error:
        raise RobotError(f"{path.name} cannot be read: {error.strerror}") from error
    if size > MESH_FILE:
        largest = MESH_FILE / 1e6
        raise RobotError(f"{path.name} has {size / 1e6:.0f} MB; at most {largest:.0f} MB are read")
    if header.startswith(b"version https://git-lfs"):
        how = "`git lfs pull` in its repository gets the file"
        raise RobotError(f"{path.name} is a pointer of Git LFS and no mesh: {how}")
    if suffix != ".dae":
        return 1.0
    return metres_of_unit(header, path.name)


def hull_solid(geometry: Mesh) -> tuple[float, FloatArray, FloatArray]:
    """Volume [m^3], centroid [m] and inertia at density 1 about it [m^5] of a mesh's convex hull.

    Raises:
        RobotError: As `convex_hull`.
    """
    hull = convex_hull(geometry)
    inertia = np.array(hull.computeMomentofInertiaRelatedToCOM(), dtype=float)
    return float(hull.computeVolume()), np.array(hull.computeCOM()), (inertia + inertia.T) / 2


def with_hull(shape: Shape) -> Shape:
    """The shape; a mesh with its hull, unless it collides as triangles that enclose nothing.

    Raises:
        RobotError: As `convex_hull`.
    """
    mesh = shape.geometry
    if not isinstance(mesh, Mesh):
        return shape
    try:
        return replace(shape, geometry=replace(mesh, hull=_measured_hull(mesh)))
    except RobotError:
        if mesh.collision != "exact":
            raise
        return shape


@lru_cache(maxsize=512)
def _measured_hull(geometry: Mesh) -> Hull:
    hull, corners = convex_hull(geometry), hull_points(geometry)
    faces = [hull.polygons(number) for number in range(hull.num_polygons)]
    first, second, third = (corners[[face[k] for face in faces]] for k in range(3))
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1)
    is_face = lengths > 0
    normals = normals[is_face] / lengths[is_face, None]
    heights = np.abs(corners @ normals.T - np.einsum("ij,ij->i", first[is_face], normals))
    return Hull(
        corners=tuple((float(x), float(y), float(z)) for x, y, z in corners),
        volume=float(hull.computeVolume()),
        centroid=tuple(np.array(hull.computeCOM()).tolist()),
        thickness=float(heights.max(axis=0).min()),
    )


def shape_solid(shape: Shape) -> tuple[float, FloatArray, FloatArray] | None:
    """Volume, centroid and inertia as of `hull_solid`, in the body's axes; None for planes.

    Raises:
        RobotError: As `convex_hull`.
    """
    if isinstance(shape.geometry, Mesh):
        volume, centroid, tensor = hull_solid(shape.geometry)
    elif (solid := solid_of(shape.geometry)) is not None:
        (volume, tensor), centroid = solid, np.zeros(3)
    else:
        return None
    rotation = shape.pose.rotation
    return volume, shape.pose.apply(centroid), rotation @ tensor @ rotation.T
