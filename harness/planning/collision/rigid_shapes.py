"""Shapes that move together, as Coal, Pinocchio and the compiled check have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from harness.core.geometry import Mesh, Shape
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.collision.convex_tree import ConvexTree
from harness.planning.collision.shape_tree import shape_box, shape_tree
from harness.planning.collision.stored_trees import stored_tree
from harness.planning.model.robot_model import RobotModel
from harness.robot.description import RobotDescription
from harness.robot.solids import coal_geometry


@dataclass(frozen=True, eq=False)
class RigidShapes:
    """Shapes that move together; scenes share them as long as they are the same.

    Attributes:
        joint: Pinocchio's joint they move with; 0 stands still.
        body_shapes: The shapes, placed on their body.
    """

    joint: int
    body_shapes: tuple[Shape, ...]
    placement: SE3

    @cached_property
    def shapes(self) -> tuple[Shape, ...]:
        """The shapes, placed on the joint."""
        return tuple(
            Shape(shape.geometry, self.placement @ shape.pose) for shape in self.body_shapes
        )

    @cached_property
    def solids(self) -> tuple[Any, ...]:
        """Coal's geometries of the shapes."""
        return tuple(map(coal_geometry, self.shapes))

    @cached_property
    def tree(self) -> ConvexTree:
        """One tree of all shapes in the frame of the joint."""
        if len(self.shapes) == 1 and not isinstance(self.shapes[0].geometry, Mesh):
            return shape_tree(self.shapes[0])
        tree = stored_tree(self.body_shapes)
        return tree.placed(self.placement.rotation, self.placement.translation)

    @cached_property
    def boxes(self) -> FloatArray:
        """The lower and the upper corner of each shape's box in the joint's frame, shape (n, 6)."""
        return np.array([shape_box(shape) for shape in self.shapes])

    @cached_property
    def box(self) -> FloatArray:
        """The lower and the upper corner of the box about them, shape (6,)."""
        return np.concatenate([self.boxes[:, :3].min(axis=0), self.boxes[:, 3:].max(axis=0)])


def rigid_shapes(
    robot: RobotModel, link: str | None, pose: SE3, shapes: Sequence[Shape]
) -> RigidShapes:
    """Shapes of a body at a pose in a link's frame, or in the world where the link is None."""
    joint, T_joint_body = 0, pose
    if link is not None:
        joint, T_joint_body = robot.parent_joint(link), robot.placement(link) @ pose
    return RigidShapes(joint, tuple(shapes), T_joint_body)


@lru_cache(maxsize=4)
def link_shapes(description: RobotDescription) -> Mapping[str, RigidShapes]:
    """The shapes of each link of a robot that has any; all its scenes share them."""
    robot = RobotModel(description)
    return {
        link.name: rigid_shapes(robot, link.name, SE3.identity(), link.collisions)
        for link in description.links
        if link.collisions
    }
