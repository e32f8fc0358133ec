"""The trees of shapes, and the boxes about them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from harness.core.geometry import (
    Box,
    Capsule,
    Cylinder,
    Geometry,
    Mesh,
    Plane,
    Shape,
    Sphere,
    reach,
)
from harness.core.types import FloatArray
from harness.planning.collision.convex_tree import (
    CYLINDER,
    HALF_SPACE,
    POINTS,
    ConvexTree,
    coal_hull,
    leaf,
    single_node,
    surface_tree,
)
from harness.robot.mesh_file import convex_hull, decomposition_of, read_triangles

_CUBE = np.array(np.meshgrid(*([-0.5, 0.5],) * 3)).reshape(3, -1).T
"""The corners of the box with sides of 1 about the origin."""


def shape_tree(shape: Shape) -> ConvexTree:
    """The tree of a shape in the frame that it is placed in.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    tree = geometry_tree(shape.geometry)
    return tree.placed(shape.pose.rotation, shape.pose.translation)


def shape_box(shape: Shape) -> FloatArray:
    """The lower and the upper corner of the box about a shape, shape (6,), in its outer frame.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    rotation, middle = shape.pose.rotation, shape.pose.translation
    if isinstance(shape.geometry, Mesh):
        points = _points(shape.geometry) @ rotation.T + middle
        return np.concatenate([points.min(axis=0), points.max(axis=0)])
    away = reach(shape.geometry, rotation)
    away = np.full(3, np.inf) if away is None else away  # a plane
    return np.concatenate([middle - away, middle + away])


def _points(geometry: Mesh) -> FloatArray:
    """Points of a mesh whose convex hull contains all of it, shape (N, 3) [m]."""
    if geometry.collision == "exact":
        return read_triangles(geometry).vertices
    found, part = decomposition_of(geometry), geometry.part
    return found.hull if part is None else found.parts[part]


@lru_cache(maxsize=1024)
def geometry_tree(geometry: Geometry) -> ConvexTree:
    """The tree of a geometry in its own frame.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    match geometry:
        case Box(size=size):
            radius = 0.5 * float(np.linalg.norm(size))
            return single_node([0.0, 0.0, 0.0, radius], POINTS, (0.0, 0.0, 0.0), _CUBE * size)
        case Sphere(radius=radius):
            return leaf(np.zeros((1, 3)), rounding=radius)
        case Capsule(radius=radius, length=length):
            return leaf(_along_z(-0.5 * length, 0.5 * length), rounding=radius)
        case Cylinder(radius=radius, length=length):
            sizes = (0.0, radius, 0.5 * length)
            return _formula(CYLINDER, sizes, float(np.hypot(radius, 0.5 * length)))
        case Plane():
            return _formula(HALF_SPACE, (0.0, 0.0, 0.0), np.inf)
        case Mesh(collision="exact"):
            mesh = read_triangles(geometry)
            return surface_tree(mesh.vertices, mesh.faces)
        case Mesh():
            return coal_hull(convex_hull(geometry))


def _along_z(*heights: float) -> FloatArray:
    return np.column_stack([np.zeros((len(heights), 2)), heights])


def _formula(kind: int, sizes: Sequence[float], radius: float) -> ConvexTree:
    """A solid about the origin whose farthest points follow from a formula."""
    return single_node([0.0, 0.0, 0.0, radius], kind, sizes, _along_z(0.0, 1.0))
