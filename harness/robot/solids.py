"""Our shapes as Coal's."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

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
