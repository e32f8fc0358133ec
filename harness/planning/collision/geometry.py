"""Converts shapes to geometries of Pinocchio's models."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import pinocchio as pin

from harness.core.geometry import Shape
from harness.planning.model.robot_model import pin_from_se3
from harness.robot.solids import coal_geometry


def geometry_object(name: str, parent_joint: int, shape: Shape) -> pin.GeometryObject:
    """Convert a shape that is placed on a Pinocchio joint (0: the world)."""
    return pin.GeometryObject(name, parent_joint, pin_from_se3(shape.pose), coal_geometry(shape))
