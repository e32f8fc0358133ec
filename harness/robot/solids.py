"""Our shapes as Coal's."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.robot.mesh_file import convex_hull, exact_surface


def coal_geometry(shape: Shape) -> Any:
    """Coal's geometry of a shape in its own frame; a mesh is its convex hull unless it is exact.

    The physics touches the same hulls.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    import coal  # here: most robots are known without their solids

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
    """Have Coal's boxes be as large as they say for as long as this process lives.

    Coal 3.0 inflates every box by 1e-10 or not at all, as the first direction in which the process
    ever asked a box for its farthest point has a zero in it or not (a function's static variable).
    Distances, and with them digests, would follow from what was measured first. This asks first,
    in a direction without zeros.
    """
    import coal

    turned = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [-2.0, -1.0, 2.0]]) / 3.0
    beside = coal.Transform3s(turned, np.array([3.0, 4.0, 5.0]))
    origin = coal.Transform3s(np.eye(3), np.zeros(3))
    cylinder, box = coal.Cylinder(0.1, 0.2), coal.Box(1.0, 1.0, 1.0)
    coal.distance(cylinder, origin, box, beside, coal.DistanceRequest(), coal.DistanceResult())
