"""How the gripper stands to what it grasps: approach axis, default grasp poses."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Shape, Sphere
from harness.core.quantity import distinct
from harness.core.spatial import SE3, rotation_from_quat_wxyz
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.recording.execution_failures import WidthFailure
from harness.recording.explanation import Explanation

GRASP_DEPTH = 0.02  # [m] below the top of a tall object
GAP_SLACK = 0.001
"""How much a gap between the pads may differ from what the robot's table says [m]."""
MAX_LEAN = 10.0  # [degrees]
UP = np.array([0.0, 0.0, 1.0])
EIGHTHS = [eighth * math.pi / 4 for eighth in (0, 4, 1, -1, 2, -2, 3, -3)]
"""Turns about the vertical, least first, half a turn being as good as none [rad]."""


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
        StepFailed: INVALID_OBJECT_NAME, when the object leans, or its shape says too little;
            GOAL_STATE_INVALID, when no level side fits between the pads.
    """
    shape, at, size, vertical, level = _standing(obj, object_pose)
    check_opening(obj, object_pose, cell)
    side = at.rotation[:, level[0]].copy()
    side[2] = 0.0
    side /= np.linalg.norm(side)
    height = size[vertical]
    point = at.translation + np.array([0.0, 0.0, height / 2 - min(GRASP_DEPTH, height / 2)])
    fits = [_fits(size[axis], cell) for axis in level]
    turns = _equal_turns(shape.geometry, vertical, fits)
    return _from_above(point, side, turns, cell)


def top_grasps_at(point: FloatArray, obj: WorldObject, object_pose: SE3, cell: Cell) -> list[SE3]:
    """The same with the TCP at a stated point, shape (3,).

    Where the object leans or its shape says too little, at every eighth of a turn.
    """
    try:
        grasps = top_grasps(obj, object_pose, cell)
    except StepFailed as failure:
        if failure.code != "INVALID_OBJECT_NAME":
            raise
        return _from_above(point, np.array([1.0, 0.0, 0.0]), EIGHTHS, cell)
    return [SE3(grasp.rotation, point) for grasp in grasps]


def _from_above(
    point: FloatArray, side: FloatArray, turns: Sequence[float], cell: Cell
) -> list[SE3]:
    """The gripper pointing down, its pads along a level direction, then turned [rad]."""
    approach, closing = gripper_axes(cell)
    rotation = _align(approach, closing, np.array([0.0, 0.0, -1.0]), side)
    return [SE3(turn_about(UP, turn) @ rotation, point) for turn in turns]


def check_opening(obj: WorldObject, object_pose: SE3, cell: Cell) -> None:
    """Compare an object's level sides with the gaps that the gripper opens and closes to.

    Raises:
        StepFailed: GOAL_STATE_INVALID, when neither side of the shape fits.
    """
    try:
        _, _, size, vertical, level = _standing(obj, object_pose)
    except StepFailed:
        return
    width, opening, least = size[level[0]], _opening(cell), least_gap(cell)
    if any(_fits(size[axis], cell) for axis in level):
        return
    too, limit, does = ("thin", least, "closes") if width < least else ("wide", opening, "opens")
    stated, most = distinct(width, limit, lambda value, more: f"{value * 1e3:.{1 + more}f} mm")
    height = f"{size[vertical] * 1e3:.1f} mm"
    other = "a thicker object, or a gripper that closes further"
    if too == "wide":
        other = "a narrower object, or a gripper that opens wider"
    raise StepFailed(
        "GOAL_STATE_INVALID",
        f"'{obj.name}' is too {too} for the gripper: {stated} across its narrowest level side, and"
        f" the gripper {does} to {most}",
        WidthFailure(width, opening, least, size[vertical]),
        Explanation(
            advice=f"its height of {height} fits: give a `grasp_pose` that takes it from the side"
            if _fits(size[vertical], cell)
            else f"take {other}: no side of it fits"
        ),
    )


def _opening(cell: Cell) -> float:
    """Largest gap between the pads [m]."""
    return float(cell.gripper.widths[:, 1].max())


def least_gap(cell: Cell) -> float:
    """Gap between the pads of the closed gripper [m]."""
    hand = cell.gripper
    return float(np.interp(hand.closed_position, hand.widths[:, 0], hand.widths[:, 1]))


def _fits(width: float, cell: Cell) -> bool:
    """Whether the gripper can hold a side of this width [m]."""
    return least_gap(cell) - GAP_SLACK <= width <= _opening(cell)


def _standing(
    obj: WorldObject, object_pose: SE3
) -> tuple[Shape, SE3, tuple[float, float, float], int, list[int]]:
    """An upright object's shape, T_world_shape, size, vertical axis and level axes, narrow first.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when it leans, or its shape says too little.
    """
    shape = _only_shape(obj)
    at = object_pose @ shape.pose
    size = _extents(obj.name, shape.geometry)
    vertical = int(np.argmax(np.abs(at.rotation[2])))
    lean = math.degrees(math.acos(min(1.0, abs(float(at.rotation[2, vertical])))))
    if lean > MAX_LEAN and not isinstance(shape.geometry, Sphere):
        raise StepFailed(
            "INVALID_OBJECT_NAME",
            f"'{obj.name}' leans by {lean:.0f} degrees, so it cannot be taken from above as it is:"
            " give a `grasp_pose`",
        )
    level = sorted((axis for axis in (1, 0, 2) if axis != vertical), key=lambda axis: size[axis])
    return shape, at, size, vertical, level


def _equal_turns(geometry: Geometry, vertical: int, fits: Sequence[bool]) -> list[float]:
    """Turns about the vertical after which a grasp is as good as before, least first [rad].

    Args:
        geometry: The shape to grasp.
        vertical: The index of the axis that points up.
        fits: Whether its narrow level side fits between the pads, then its wide one.
    """
    upright = isinstance(geometry, Cylinder | Capsule) and vertical == 2
    if upright or isinstance(geometry, Sphere):
        return EIGHTHS
    narrow, wide = fits
    quarters = [0, 2] * narrow + [1, -1] * wide
    return [quarter * math.pi / 2 for quarter in quarters]


def grasp_points(obj: WorldObject, object_pose: SE3) -> list[FloatArray]:
    """Points of an object that an inclined gripper closes on, shape (3,) each.

    Its shape's middle; of one that stands upright also the point that grasps from above use and the
    top, since the fingertips reach beyond the TCP and must stay above what the object stands on.
    """
    if len(obj.shapes) != 1:
        return [object_pose.translation]
    middle = (object_pose @ obj.shapes[0].pose).translation
    try:
        _, _, size, vertical, _ = _standing(obj, object_pose)
    except StepFailed:
        return [middle]
    top = size[vertical] / 2
    rises = dict.fromkeys((0.0, max(0.0, top - GRASP_DEPTH), top))
    return [middle + rise * UP for rise in rises]


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


def matrix_pitch(rotation: FloatArray) -> float:
    """Angle of a frame's x axis below the horizontal [rad]."""
    return -math.asin(float(np.clip(rotation[2, 0], -1.0, 1.0)))


def turn_about(axis: FloatArray, angle: float) -> FloatArray:
    """Rotation about a unit axis by an angle [rad], shape (3, 3)."""
    return rotation_from_quat_wxyz([math.cos(angle / 2), *(math.sin(angle / 2) * axis)])
