"""Mesh files as triangles, convex hulls and parts, for planner and physics alike.

As in MoveIt and RViz, a COLLADA file's `unit` is applied and its `up_axis` is not; nor is a GLB
file turned, whose second axis points up by convention.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from harness.core.errors import RobotError
from harness.core.geometry import Mesh, Shape
from harness.core.solids import solid_of
from harness.core.types import FloatArray, IntArray
from harness.robot.decomposition.convex_parts import Decomposition, stored_decomposition

SUFFIXES = (".stl", ".obj", ".dae", ".ply", ".glb")
KINDS = "STL, OBJ, DAE, PLY or GLB"
LARGEST_FILE = 64_000_000
"""Largest mesh file [bytes]."""

FLAT = 1e-9
"""Thickness below which a mesh is flat [m]."""

HEADER = 20_000
UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']\s*([0-9.eE+-]+)\s*[\"']")
ROOT = b"<COLLADA"
DECLARATION = re.compile(rb"<!\s*(DOCTYPE|ENTITY)", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Triangles:
    """A mesh.

    Attributes:
        vertices: Vertices, shape (N, 3) [m].
        faces: Indices of vertices, shape (M, 3).
    """

    vertices: FloatArray
    faces: IntArray


@lru_cache(maxsize=128)
def read_triangles(geometry: Mesh) -> Triangles:
    """All triangles of a file.

    Raises:
        RobotError: The file is of an unsupported kind, too large, or damaged.
    """
    import trimesh  # here: most robots are loaded without reading their meshes

    path = geometry.path
    scale = np.array(geometry.scale, dtype=float) * metres_per_unit(geometry)
    kind = path.suffix[1:].lower()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # As a stream, so that the file cannot name others, such as textures.
            stream = io.BytesIO(path.read_bytes())
            scene = trimesh.load_scene(stream, file_type=kind, process=False, skip_materials=True)
            mesh = scene.to_mesh()
            mesh.merge_vertices(merge_tex=True, merge_norm=True)
        vertices, faces = np.array(mesh.vertices) * scale, np.array(mesh.faces, dtype=np.int64)
        corners = vertices[faces]
    except Exception as error:  # every format's reader has errors of its own
        raise RobotError(
            f"{path.name} cannot be read: it is damaged or not in {kind.upper()} format"
        ) from error
    if not np.isfinite(corners).all():
        raise RobotError(f"{path.name} has corners that are not finite numbers: it is damaged")
    if not len(faces):
        raise RobotError(
            f"{path.name} has no triangles: it is empty, damaged or not in {kind.upper()} format"
        )
    return Triangles(vertices, faces)


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


def _thickness(points: FloatArray) -> float:
    """Extent of points along the normal of the plane nearest to them [m]."""
    away = points - points.mean(axis=0)
    normal = np.linalg.eigh(away.T @ away)[1][:, 0]
    return float(np.ptp(away @ normal))


def hull_of(points: FloatArray) -> Any:
    """The convex hull of points as Coal's geometry.

    Raises:
        RuntimeError: The points are in a plane, or Qhull fails.
    """
    import coal

    if _thickness(points) < FLAT:  # Qhull can crash on such points
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

    Raises:
        RobotError: As `convex_hull`.
    """
    return _decomposition(Mesh(geometry.path, geometry.scale))


@lru_cache(maxsize=512)
def _decomposition(geometry: Mesh) -> Decomposition:
    def triangles() -> FloatArray:
        mesh = read_triangles(geometry)
        if _thickness(mesh.vertices) < FLAT:  # Qhull can crash on such points
            raise RobotError(f"{geometry.path.name} is flat: it encloses nothing to touch")
        return mesh.vertices[mesh.faces]

    factors = np.array(geometry.scale) * metres_per_unit(geometry)
    with _hull_errors(geometry):
        return stored_decomposition(geometry.path.read_bytes(), factors, triangles)


def hull_points(geometry: Mesh) -> FloatArray:
    """Corners of the convex hull, shape (N, 3) [m]."""
    hull = convex_hull(geometry)
    return np.array(hull.points(), dtype=float).reshape(-1, 3)


def metres_per_unit(geometry: Mesh) -> float:
    """Metres of a COLLADA file's unit; 1 for other files, which are in metres.

    Raises:
        RobotError: The file is of an unsupported kind, too large, or declares entities.
    """
    path = geometry.path
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise RobotError(f"{path.name} is not a {KINDS} file")
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            header = file.read(HEADER)
    except OSError as error:
        raise RobotError(f"{path.name} cannot be read: {error.strerror}") from error
    if size > LARGEST_FILE:
        largest = LARGEST_FILE / 1e6
        raise RobotError(f"{path.name} has {size / 1e6:.0f} MB; at most {largest:.0f} MB are read")
    if suffix != ".dae":
        return 1.0
    if ROOT not in header:
        raise RobotError(f"{path.name} is not a COLLADA file")
    if DECLARATION.search(header):
        raise RobotError(f"{path.name} declares a document type or entities, which are not read")
    found = UNIT.search(header)
    unit = float(found[1]) if found else 1.0
    return unit if unit > 0 else 1.0


def hull_solid(geometry: Mesh) -> tuple[float, FloatArray, FloatArray]:
    """Volume [m^3], centroid [m] and inertia at density 1 about it [m^5] of a mesh's convex hull.

    Raises:
        RobotError: As `convex_hull`.
    """
    hull = convex_hull(geometry)
    inertia = np.array(hull.computeMomentofInertiaRelatedToCOM(), dtype=float)
    return float(hull.computeVolume()), np.array(hull.computeCOM()), (inertia + inertia.T) / 2


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
