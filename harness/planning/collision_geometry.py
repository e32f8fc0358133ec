"""Our shapes as Coal's."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.planning.robot_model import pin_from_se3
from harness.robot.mesh_file import convex_hull


def coal_geometry(shape: Shape) -> coal.CollisionGeometry:
    """Coal's geometry of a shape, in the shape's own frame; meshes as their convex hulls.

    The physics touches the same hulls.

    Raises:
        RobotError: A mesh file cannot be read.
    """
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
            return convex_hull(mesh)


def geometry_object(
    name: str, parent_joint: int, T_joint_body: SE3, shape: Shape
) -> pin.GeometryObject:
    """A shape of a body, fixed to a Pinocchio joint (0: the world)."""
    placement = pin_from_se3(T_joint_body @ shape.pose)
    return pin.GeometryObject(name, parent_joint, placement, coal_geometry(shape))
