"""Converts shapes to geometries of Pinocchio's models."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import pinocchio as pin

from harness.core.geometry import Shape
from harness.core.spatial import SE3
from harness.planning.model.robot_model import pin_from_se3
from harness.robot.solids import coal_geometry


def geometry_object(
    name: str, parent_joint: int, T_joint_body: SE3, shape: Shape
) -> pin.GeometryObject:
    """Convert a shape of a body that is fixed to a Pinocchio joint (0: the world)."""
    placement = pin_from_se3(T_joint_body @ shape.pose)
    return pin.GeometryObject(name, parent_joint, placement, coal_geometry(shape))
