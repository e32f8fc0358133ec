"""Converts shapes to Coal's geometries."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.robot.mesh_file import convex_hull, exact_surface


def coal_geometry(shape: Shape) -> Any:
    """Coal's geometry of a shape in its own frame; a mesh is its convex hull unless it is exact.

    The physics collides with the same hulls.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    import coal  # here: most robots are loaded without their solids

    match shape.geometry:
        case Box(size=size):
            _settle_boxes()
            return coal.Box(*size)
        case Cylinder(radius=radius, length=length):
            return coal.Cylinder(radius, length)
        case Sphere(radius=radius):
            return coal.Sphere(radius)
        case Capsule(radius=radius, length=length):
            return coal.Capsule(radius, length)
        case Plane():
            return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        case Mesh() as mesh:
            return exact_surface(mesh) if mesh.exact else convex_hull(mesh)


@cache
def _settle_boxes() -> None:
    """Make Coal use the exact size of boxes in this process.

    Coal 3.0 inflates all boxes by 1e-10 if the direction of the process's first support query for a
    box has a zero component (a static variable). Distances and digests would depend on the first
    query, so this function makes that query with a direction without zeros.
    """
    import coal

    turned = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [-2.0, -1.0, 2.0]]) / 3.0
    apart = coal.Transform3s(turned, np.array([3.0, 4.0, 5.0]))
    origin = coal.Transform3s(np.eye(3), np.zeros(3))
    cylinder, box = coal.Cylinder(0.1, 0.2), coal.Box(1.0, 1.0, 1.0)
    coal.distance(cylinder, origin, box, apart, coal.DistanceRequest(), coal.DistanceResult())
