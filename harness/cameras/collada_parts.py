"""COLLADA files as coloured triangles."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from harness.cameras.mesh_part import MeshPart, coarsen
from harness.core.errors import RobotError
from harness.core.geometry import Mesh, Rgba
from harness.robot.mesh_file import metres_per_unit


def load_collada(geometry: Mesh) -> tuple[MeshPart, ...]:
    """The triangles of a file's scene, one part per colour.

    As in the collision geometry of the same file, its `unit` is applied and its `up_axis` is not.

    Raises:
        RobotError: The file is too large or damaged, or its scene has no triangles.
    """
    import collada  # here: few robots have COLLADA files
    import collada.common

    scale = metres_per_unit(geometry) * np.array(geometry.scale)
    unknown = [collada.common.DaeUnsupportedError, collada.common.DaeBrokenRefError]
    try:
        with warnings.catch_warnings():  # the library uses numpy.matrix
            warnings.simplefilter("ignore", PendingDeprecationWarning)
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
