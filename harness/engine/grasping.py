"""How the gripper stands to what it grasps: approach axis, default grasp poses."""

from __future__ import annotations

import math

import numpy as np

from harness.core.errors import StepFailed
from harness.core.geometry import Box, Capsule, Cylinder, Sphere
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.engine.cell import Cell

GRASP_DEPTH = 0.02  # [m] below the top of a tall object


def gripper_axes(cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Unit approach and closing axes in the TCP frame, shape (3,) each.

    The approach axis points from the palm to the TCP, the closing axis from one pad to the other.
    """
    gripper = cell.gripper
    state = cell.planning_start()
    world_to_tcp = cell.kinematics.link_pose(state, cell.description.tcp_link).inverse()
    palm = world_to_tcp @ cell.kinematics.link_pose(state, gripper.palm_link)
    first, second = (
        world_to_tcp @ cell.kinematics.link_pose(state, link) for link in gripper.pads.values()
    )
    approach = -palm.translation
    closing = second.translation - first.translation
    closing = closing - approach * float(closing @ approach) / float(approach @ approach)
    return approach / np.linalg.norm(approach), closing / np.linalg.norm(closing)


def top_grasp(obj: WorldObject, object_pose: SE3, cell: Cell) -> SE3:
    """T_world_tcp that takes an upright object from above, across its narrow side.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when the object is too wide, or its shape says too little.
    """
    width_axis, width, height = _narrow_side(obj)
    opening = float(cell.gripper.widths[:, 1].max())
    if width > opening:
        raise StepFailed(
            "INVALID_OBJECT_NAME",
            f"'{obj.name}' is {width * 1e3:.0f} mm wide, the gripper opens {opening * 1e3:.0f} mm:"
            " give a `grasp_pose`",
        )
    approach, closing = gripper_axes(cell)
    side = object_pose.rotation @ width_axis
    side = np.array([side[0], side[1], 0.0])
    side /= np.linalg.norm(side)
    down = np.array([0.0, 0.0, -1.0])
    rotation = _align(approach, closing, down, side)
    depth = min(GRASP_DEPTH, height / 2)
    top = object_pose.translation + np.array([0.0, 0.0, height / 2 - depth])
    return SE3(rotation, top)


def _narrow_side(obj: WorldObject) -> tuple[FloatArray, float, float]:
    """Body axis across which the object is narrow, its width there, its height (z) [m]."""
    if len(obj.shapes) == 1:
        match obj.shapes[0].geometry:
            case Box(size=(x, y, z)):
                return (np.array([1.0, 0, 0]), x, z) if x <= y else (np.array([0, 1.0, 0]), y, z)
            case Cylinder(radius=radius, length=length):
                return np.array([0, 1.0, 0]), 2 * radius, length
            case Capsule(radius=radius, length=length):
                return np.array([0, 1.0, 0]), 2 * radius, length + 2 * radius
            case Sphere(radius=radius):
                return np.array([0, 1.0, 0]), 2 * radius, 2 * radius
            case _:
                pass
    raise StepFailed(
        "INVALID_OBJECT_NAME", f"'{obj.name}' has no simple shape: give a `grasp_pose`"
    )


def _align(
    approach: FloatArray, closing: FloatArray, target_approach: FloatArray, side: FloatArray
) -> FloatArray:
    """Rotation that takes the TCP's approach and closing axes to directions in the world."""
    in_tcp = np.column_stack([approach, closing, np.cross(approach, closing)])
    in_world = np.column_stack([target_approach, side, np.cross(target_approach, side)])
    return in_world @ in_tcp.T


def pitch_of(rotation: FloatArray) -> float:
    """Angle of a frame's x axis below the horizontal [rad]."""
    return -math.asin(float(np.clip(rotation[2, 0], -1.0, 1.0)))
