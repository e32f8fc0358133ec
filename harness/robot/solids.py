"""Converts shapes to Coal's geometries."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.types import FloatArray
from harness.robot.mesh_file import convex_hull, exact_surface

DOT = 1e-6  # Radius of the sphere that stands for a point, since Coal has none [m]


def coal_geometry(shape: Shape) -> Any:
    """Coal's geometry of a shape in its own frame.

    A mesh is its convex hull or one of its convex parts, as in the physics; or its triangles, where
    its collision mode is `exact`.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    import coal  # here: most robots are loaded without their solids

    match shape.geometry:
        case Box(size=size):
            return _box(size)
        case Cylinder(radius=radius, length=length):
            return coal.Cylinder(radius, length)
        case Sphere(radius=radius):
            return coal.Sphere(radius)
        case Capsule(radius=radius, length=length):
            return coal.Capsule(radius, length)
        case Plane():
            return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        case Mesh() as mesh:
            return exact_surface(mesh) if mesh.collision == "exact" else convex_hull(mesh)


def box_corners(solid: Any) -> FloatArray:
    """Corners of the box around one of Coal's geometries, along its own axes, shape (8, 3) [m]."""
    solid.computeLocalAABB()
    low, high = np.array(solid.aabb_local.min_), np.array(solid.aabb_local.max_)
    return np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T


def nearest_point(shapes: Iterable[Shape], point: FloatArray) -> FloatArray:
    """The point of shapes that is nearest to a point, that point inside one, shape (3,) [m]."""
    import coal

    dot, at = coal.Sphere(DOT), coal.Transform3s(np.eye(3), np.asarray(point, dtype=float))
    nearest = coal.DistanceResult()
    for shape in shapes:
        placed = coal.Transform3s(np.asarray(shape.pose.rotation), shape.pose.translation)
        result, request = coal.DistanceResult(), coal.DistanceRequest()
        coal.distance(coal_geometry(shape), placed, dot, at, request, result)
        if result.min_distance <= 0:
            return np.array(point, dtype=float)
        if result.min_distance < nearest.min_distance:
            nearest = result
    return np.array(nearest.getNearestPoint1())


def _box(size: tuple[float, float, float]) -> Any:
    """A box as a convex body of eight corners.

    Coal 3.0 makes one side of each `coal.Box` longer by 1e-10 if the first support query that any
    code of the process made for a box was along one of its axes (a static variable). Distances and
    digests would depend on what ran before.
    """
    import coal

    corners = coal.StdVec_Vec3s()
    corners.extend(list(_UNIT_CORNERS * size))
    return coal.Convex(corners, _sides())


_UNIT_CORNERS = np.array([*product((-0.5, 0.5), repeat=3)])


@cache
def _sides() -> Any:
    """The sides of a box as triangles of `_UNIT_CORNERS`, seen counterclockwise from outside."""
    import coal

    corners = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    sides = coal.StdVec_Triangle()
    for a, b, c, d in corners:
        sides.extend([coal.Triangle(a, b, c), coal.Triangle(a, c, d)])
    return sides
