"""How the gripper stands to what it grasps: approach axis, default grasp poses."""

from __future__ import annotations

import math

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Shape, Sphere
from harness.core.spatial import SE3, rotation_from_quat_wxyz
from harness.core.types import FloatArray
from harness.core.world import WorldObject

GRASP_DEPTH = 0.02  # [m] below the top of a tall object
MAX_LEAN = 10.0  # [degrees]
UP = np.array([0.0, 0.0, 1.0])


def gripper_axes(cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Unit approach and closing axes in the TCP frame, shape (3,) each.

    The approach axis points from the palm to the TCP, the closing axis from one pad to the other
    with the hand open: closed, the frames of the pads may be in one place.
    """
    gripper = cell.gripper
    state = cell.planning_start()
    state[cell.description.joint_index[gripper.joint]] = gripper.open_position
    state = cell.description.with_mimics(state)
    world_to_tcp = cell.kinematics.link_pose(state, cell.description.tcp_link).inverse()
    palm = world_to_tcp @ cell.kinematics.link_pose(state, gripper.palm_link)
    first, second = (
        world_to_tcp @ cell.kinematics.link_pose(state, link) for link in gripper.pads.values()
    )
    approach = -palm.translation
    closing = second.translation - first.translation
    closing = closing - approach * float(closing @ approach) / float(approach @ approach)
    return approach / np.linalg.norm(approach), closing / np.linalg.norm(closing)


def top_grasps(obj: WorldObject, object_pose: SE3, cell: Cell) -> list[SE3]:
    """T_world_tcp of every way to take an object from above, as its shape and the gripper have it.

    Across the narrow one of its level sides comes first, then half a turn of that: two fingers are
    alike. A box is taken across its wider side too if the gripper opens so far; what is round about
    the vertical, at every eighth of a turn.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when the object is too wide, leans, or its shape says too
            little.
    """
    shape = _only_shape(obj)
    at = object_pose @ shape.pose
    size = _extents(obj.name, shape.geometry)
    vertical = int(np.argmax(np.abs(at.rotation[2])))
    lean = math.degrees(math.acos(min(1.0, abs(float(at.rotation[2, vertical])))))
    if lean > MAX_LEAN and not isinstance(shape.geometry, Sphere):
        raise StepFailed(
            "INVALID_OBJECT_NAME",
            f"'{obj.name}' leans by {lean:.0f} degrees, which is no way to take it from above:"
            " give a `grasp_pose`",
        )
    level = sorted((axis for axis in (1, 0, 2) if axis != vertical), key=lambda axis: size[axis])
    opening = float(cell.gripper.widths[:, 1].max())
    if size[level[0]] > opening:
        raise StepFailed(
            "INVALID_OBJECT_NAME",
            f"'{obj.name}' is {size[level[0]] * 1e3:.0f} mm wide, the gripper opens"
            f" {opening * 1e3:.0f} mm: give a `grasp_pose`",
        )
    approach, closing = gripper_axes(cell)
    side = at.rotation[:, level[0]].copy()
    side[2] = 0.0
    side /= np.linalg.norm(side)
    rotation = _align(approach, closing, np.array([0.0, 0.0, -1.0]), side)
    height = size[vertical]
    point = at.translation + np.array([0.0, 0.0, height / 2 - min(GRASP_DEPTH, height / 2)])
    turns = _equal_turns(shape.geometry, vertical, fits_across=size[level[1]] <= opening)
    return [SE3(turn_about(UP, turn) @ rotation, point) for turn in turns]


def _equal_turns(geometry: Geometry, vertical: int, *, fits_across: bool) -> list[float]:
    """Turns about the vertical after which a grasp is as good as before, least first [rad]."""
    upright = isinstance(geometry, Cylinder | Capsule) and vertical == 2
    if upright or isinstance(geometry, Sphere):
        eighths = [0, 4, 1, -1, 2, -2, 3, -3]
    else:
        eighths = [0, 4, 2, -2] if fits_across else [0, 4]
    return [eighth * math.pi / 4 for eighth in eighths]


def grasp_point(obj: WorldObject, object_pose: SE3) -> FloatArray:
    """Point of an object that a gripper from the side closes on: its shape's middle, shape (3,)."""
    if len(obj.shapes) != 1:
        return object_pose.translation
    return (object_pose @ obj.shapes[0].pose).translation


def _only_shape(obj: WorldObject) -> Shape:
    if len(obj.shapes) == 1:
        return obj.shapes[0]
    raise StepFailed(
        "INVALID_OBJECT_NAME", f"'{obj.name}' has {len(obj.shapes)} shapes: give a `grasp_pose`"
    )


def _extents(name: str, geometry: Geometry) -> tuple[float, float, float]:
    """Size of a shape along its own axes [m]."""
    match geometry:
        case Box(size=size):
            return size
        case Cylinder(radius=radius, length=length):
            return 2 * radius, 2 * radius, length
        case Capsule(radius=radius, length=length):
            return 2 * radius, 2 * radius, length + 2 * radius
        case Sphere(radius=radius):
            return 2 * radius, 2 * radius, 2 * radius
        case _:
            raise StepFailed(
                "INVALID_OBJECT_NAME", f"'{name}' has no simple shape: give a `grasp_pose`"
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


def turn_about(axis: FloatArray, angle: float) -> FloatArray:
    """Rotation about a unit axis by an angle [rad], shape (3, 3)."""
    return rotation_from_quat_wxyz([math.cos(angle / 2), *(math.sin(angle / 2) * axis)])
