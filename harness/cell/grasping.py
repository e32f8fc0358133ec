"""Geometry of grasps: approach axis, openings, default grasp poses."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from harness.cell.approach import approach_axis
from harness.cell.cell import Cell
from harness.cell.grip import grip_of
from harness.core.errors import StepFailed
from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Plane, Shape, Sphere, reach
from harness.core.pose_arrays import rotations_about
from harness.core.quantity import distinct
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.recording.execution_failures import WidthFailure
from harness.robot.end_effector import Gripper

GRASP_DEPTH = 0.02  # [m] below the top of a tall object
CLEARANCE = 0.005  # [m], of the palm from an object's top, and of fingertips from its bottom
JAW_CLEARANCE = 0.004  # [m], between an object and the palm on which a single jaw closes
CLOSING_STATES = 5  # of a closing hand at which its fingertips are measured: they swing on arcs
GAP_SLACK = 0.001  # [m], by which a gap between the pads may differ from the robot's table
MAX_LEAN = 10.0  # [degrees]
AJAR = 0.2  # share of its travel by which a jaw is open where its closing direction is measured
IN_ONE_PLACE = 1e-4  # [m], up to which two points are in one place
HEADINGS = 4  # corrections of a gripper's heading, which follows from where its TCP is
UP = np.array([0.0, 0.0, 1.0])
EIGHTHS = [eighth * math.pi / 4 for eighth in (0, 4, 1, -1, 2, -2, 3, -3)]
"""Turns about the vertical, least first, half a turn being as good as none [rad]."""


def gripper_axes(cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Unit approach and closing axes in the TCP frame, shape (3,) each.

    The closing axis leads from one pad to the other with the hand open: closed, the frames of the
    pads may be in one place. With a single jaw it is normal to the palm's surface.
    """
    opened = _at(cell, cell.gripper.open_position)
    approach = approach_axis(cell.description, cell.kinematics, cell.scene, opened)
    if cell.gripper.cups:  # nothing closes: any direction across
        return approach, np.linalg.svd(approach[None])[2][1]
    _, first, second = _in_tcp(cell, cell.gripper.open_position)
    closing = second.translation - first.translation
    if np.linalg.norm(closing) < IN_ONE_PLACE:  # then from the middle of one pad's shapes
        placed = zip(cell.gripper.pads.values(), (first, second), strict=True)
        middles = [at.apply(cell.scene.corners(link)).mean(axis=0) for link, at in placed]
        closing = middles[1] - middles[0]
    if cell.gripper.has_single_jaw:
        closing = _from_palm_to_jaw(cell)
        approach = approach - closing * float(closing @ approach) / float(closing @ closing)
    closing = closing - approach * float(closing @ approach) / float(approach @ approach)
    return approach / np.linalg.norm(approach), closing / np.linalg.norm(closing)


def _from_palm_to_jaw(cell: Cell) -> FloatArray:
    """The normal of the palm's surface on which a single jaw closes, TCP axes, shape (3,) [m].

    It is measured where the jaw's point that closes at the TCP is with the hand a little open.
    """
    gripper = cell.gripper
    number = list(gripper.pads.values()).index(_jaw(cell))
    ends = gripper.closed_position, gripper.open_position
    closed, ajar = (
        _in_tcp(cell, ends[0] + share * (ends[1] - ends[0]))[1 + number] for share in (0, AJAR)
    )
    point = (ajar @ closed.inverse()).translation
    palm = _in_tcp(cell, ends[0])[0]
    surface = cell.scene.nearest_on_link(gripper.palm_link, palm.inverse().apply(point))
    normal = point - palm.apply(surface)
    return normal if np.linalg.norm(normal) > IN_ONE_PLACE else point


def _jaw(cell: Cell) -> str:
    """The pad that moves relative to the palm."""
    return next(pad for pad in cell.gripper.pads.values() if pad != cell.gripper.palm_link)


def _at(cell: Cell, position: float) -> FloatArray:
    """The whole robot with its gripper's joint at a position, description order."""
    state = cell.planning_start()
    state[cell.description.joint_index[cell.gripper.joint]] = position
    return cell.description.with_mimics(state)


def _in_tcp(cell: Cell, position: float) -> tuple[SE3, SE3, SE3]:
    """The palm's and the pads' poses in the TCP frame at a position of the gripper's joint."""
    gripper, state = cell.gripper, _at(cell, position)
    world_to_tcp = cell.kinematics.link_pose(state, cell.description.tcp_link).inverse()
    palm, first, second = (
        world_to_tcp @ cell.kinematics.link_pose(state, link)
        for link in (gripper.palm_link, *gripper.pads.values())
    )
    return palm, first, second


def grasp_depth(cell: Cell, height: float, width: float) -> float:
    """How far below the top of an object the TCP grasps it [m].

    The palm stays above the top, and the fingertips above the bottom from where they are open to
    where they close on the object, where both are possible. A palm that is a pad itself, next to a
    single jaw, touches the object anyway.
    """
    gripper, approach = cell.gripper, gripper_axes(cell)[0]

    def extent(link: str, pose: SE3) -> float:
        return float((pose.apply(cell.scene.corners(link)) @ approach).max())

    positions = gripper.open_position, position_for_width(gripper, width)
    tips = max(
        extent(link, pose)
        for position in np.linspace(*positions, CLOSING_STATES)
        for link, pose in zip(gripper.pads.values(), _in_tcp(cell, position)[1:], strict=True)
    )
    depth = min(GRASP_DEPTH, height / 2, height - tips - min(CLEARANCE, height / 4))
    if gripper.has_single_jaw:
        return depth
    room = extent(gripper.palm_link, _in_tcp(cell, gripper.open_position)[0])
    return min(depth, -room - CLEARANCE)


def top_grasps(obj: WorldObject, object_pose: SE3, cell: Cell) -> list[SE3]:
    """T_world_tcp of every grasp of an object from above, by its shape and the gripper's.

    Across the narrow one of its level sides comes first, then half a turn of that: two fingers are
    alike. A box is taken across its wider side too if the gripper opens so far; what is round about
    the vertical, at every eighth of a turn. A mesh, or several shapes, are taken as the box around
    them.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when the object leans, or its shape says too little;
            GOAL_STATE_INVALID, when no level side fits between the pads.
    """
    if grip := grip_of(cell.gripper):
        return grip.grasps(obj, object_pose, cell)
    shape, at, size, vertical, level = _standing(obj, object_pose, cell)
    check_opening(obj, object_pose, cell)
    side = at.rotation[:, level[0]].copy()
    side[2] = 0.0
    side /= np.linalg.norm(side)
    height = size[vertical]
    fits = [can_hold(size[axis], cell) for axis in level]
    widths = [size[axis] for axis, does_fit in zip(level, fits, strict=True) if does_fit]
    depth = grasp_depth(cell, height, min(widths))
    point = at.translation + np.array([0.0, 0.0, height / 2 - depth])
    turns = _equal_turns(shape.geometry, vertical, fits)
    shift = _room_for_width(cell, max(widths))
    return [
        SE3(grasp.rotation, grasp.translation - grasp.rotation @ shift)
        for grasp in _from_above(point, side, turns, cell)
    ]


def _room_for_width(cell: Cell, width: float) -> FloatArray:
    """Displacement from the TCP to the middle of a grasped object, TCP axes, shape (3,) [m].

    Zero between two fingers. A single jaw pushes the object against the palm, whose surface may
    be nearer to the TCP than half of the object's width.
    """
    gripper = cell.gripper
    if not cell.gripper.has_single_jaw:
        return np.zeros(3)
    tcp = _in_tcp(cell, gripper.open_position)[0].inverse().translation
    away = float(np.linalg.norm(tcp - cell.scene.nearest_on_link(gripper.palm_link, tcp)))
    missing = 0.5 * width + JAW_CLEARANCE - away
    return max(missing, 0.0) * gripper_axes(cell)[1]


def top_grasps_at(point: FloatArray, obj: WorldObject, object_pose: SE3, cell: Cell) -> list[SE3]:
    """The grasps of `top_grasps` with the TCP at a stated point, shape (3,).

    Where the object leans, or is not one simple shape, at every eighth of a turn.
    """
    if grip := grip_of(cell.gripper):
        return grip.grasps_at(point)
    if has_simple_shape(obj):
        try:
            return [SE3(each.rotation, point) for each in top_grasps(obj, object_pose, cell)]
        except StepFailed as failure:
            if failure.code != "INVALID_OBJECT_NAME":
                raise
    return _from_above(point, np.array([1.0, 0.0, 0.0]), EIGHTHS, cell)


def _from_above(
    point: FloatArray, side: FloatArray, turns: Sequence[float], cell: Cell
) -> list[SE3]:
    """The gripper pointing down, its pads along a level direction, then turned [rad]."""
    approach, closing = gripper_axes(cell)
    rotation = align(approach, closing, np.array([0.0, 0.0, -1.0]), side)
    return [SE3(rotations_about(UP, turn) @ rotation, point) for turn in turns]


def grasps_at_pitches(
    point: FloatArray, obj: WorldObject, pitches: Sequence[float], axis: FloatArray, cell: Cell
) -> list[SE3]:
    """T_world_tcp of grasps at a point (3,) by an arm that turns about the vertical at `axis` (3,).

    The gripper points away from the axis and below the horizontal by each pitch [rad], its closing
    axis level; then the same half a turn about the approach.
    """
    approach, closing = gripper_axes(cell)
    shift = _room_for_width(cell, _width_across(obj, cell))
    grasps: list[SE3] = []
    for pitch, roll in itertools.product(pitches, (1.0, -1.0)):
        tcp, rotation = point, np.eye(3)
        for _ in range(HEADINGS):
            heading = math.atan2(tcp[1] - axis[1], tcp[0] - axis[0])
            ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
            along = math.cos(pitch) * ahead - math.sin(pitch) * UP
            rotation = align(approach, closing, along, roll * np.cross(UP, ahead))
            tcp = point - rotation @ shift
        grasps.append(SE3(rotation, tcp))
    return grasps


def _width_across(obj: WorldObject, cell: Cell) -> float:
    """The narrower level side of an object, 0 where it leans or has none [m]."""
    try:
        _, _, size, _, level = _standing(obj, cell.frame(obj.name), cell)
    except StepFailed:
        return 0.0
    return size[level[0]]


def is_grasped_by_pitch(cell: Cell, group: str) -> bool:
    """Whether a position and the pitch of the TCP's x axis state an arm's grasp.

    They do where the arm can hold no tilt, if the gripper points along that axis.
    """
    if cell.description.task_space(group).holds_tilt:
        return False
    return float(gripper_axes(cell)[0][0]) > math.cos(math.radians(MAX_LEAN))


def check_opening(obj: WorldObject, object_pose: SE3, cell: Cell) -> None:
    """Compare an object's level sides with the gaps that the gripper opens and closes to.

    Raises:
        StepFailed: GOAL_STATE_INVALID, when neither side of the shape fits, or of the box around
            a mesh or several shapes.
    """
    try:
        _, _, size, vertical, level = _standing(obj, object_pose, cell)
    except StepFailed:
        return
    width, opening, least = size[level[0]], widest(cell), least_gap(cell)
    if any(can_hold(size[axis], cell) for axis in level):
        return
    too, limit, does = ("thin", least, "closes") if width < least else ("wide", opening, "opens")
    stated, most = distinct(width, limit, lambda value, more: f"{value * 1e3:.{1 + more}f} mm")
    whose = "its" if has_simple_shape(obj) else "its box's"
    raise StepFailed(
        "GOAL_STATE_INVALID",
        f"'{obj.name}' is too {too} for the gripper: {stated} across {whose} narrowest level side,"
        f" and the gripper {does} to {most}",
        WidthFailure(width, opening, least, size[vertical]),
    )


def level_sides(obj: WorldObject, object_pose: SE3, cell: Cell) -> tuple[tuple[float, bool], ...]:
    """The level sides of an upright object, narrow first: width [m], and whether it can be held.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when it leans, or has no shape that can be held.
    """
    _, _, size, _, level = _standing(obj, object_pose, cell)
    return tuple((size[axis], can_hold(size[axis], cell)) for axis in level)


def widest(cell: Cell) -> float:
    """Largest gap between the pads [m]."""
    return float(cell.gripper.widths[:, 1].max())


def position_for_width(hand: Gripper, width: float) -> float:
    """Position of the gripper's joint at which the pads are `width` apart [m]."""
    rows = hand.widths[np.argsort(hand.widths[:, 1])]
    return float(np.interp(width, rows[:, 1], rows[:, 0]))


def least_gap(cell: Cell) -> float:
    """Gap between the pads of the closed gripper [m]."""
    hand = cell.gripper
    return float(hand.gap_at(hand.closed_position))


def can_hold(width: float, cell: Cell) -> bool:
    """Whether the gripper can hold a side of this width [m]."""
    return least_gap(cell) - GAP_SLACK <= width <= widest(cell)


def _standing(
    obj: WorldObject, object_pose: SE3, cell: Cell
) -> tuple[Shape, SE3, tuple[float, float, float], int, list[int]]:
    """An upright object's shape, T_world_shape, size, vertical axis and level axes, narrow first.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when it leans, or has no shape that can be held.
    """
    shape = obj.shapes[0] if has_simple_shape(obj) else _box_around(obj, cell)
    at = object_pose @ shape.pose
    half = reach(shape.geometry, np.eye(3))
    assert half is not None  # of no plane and no mesh
    size = (2 * float(half[0]), 2 * float(half[1]), 2 * float(half[2]))
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
        fits: Whether its narrow level side fits between the pads, then its wide one.
    """
    upright = isinstance(geometry, Cylinder | Capsule) and vertical == 2
    if upright or isinstance(geometry, Sphere):
        return EIGHTHS
    narrow, wide = fits
    quarters = [0, 2] * narrow + [1, -1] * wide
    return [quarter * math.pi / 2 for quarter in quarters]


def grasp_points(obj: WorldObject, object_pose: SE3, cell: Cell) -> list[FloatArray]:
    """Points of an object that an inclined gripper closes on, shape (3,) each.

    Its shape's middle; of one that stands upright also the point that grasps from above use and the
    top, since the fingertips reach beyond the TCP and must stay above what the object stands on.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when it has no shape that can be held.
    """
    shape = obj.shapes[0] if has_simple_shape(obj) else _box_around(obj, cell)
    middle = (object_pose @ shape.pose).translation
    try:
        _, _, size, vertical, _ = _standing(obj, object_pose, cell)
    except StepFailed:
        return [middle]
    top = size[vertical] / 2
    rises = dict.fromkeys((0.0, max(0.0, top - GRASP_DEPTH), top))
    return [middle + rise * UP for rise in rises]


def has_simple_shape(obj: WorldObject) -> bool:
    """Whether an object is one box, cylinder, capsule or sphere."""
    simple = Box | Cylinder | Capsule | Sphere
    return len(obj.shapes) == 1 and isinstance(obj.shapes[0].geometry, simple)


def _box_around(obj: WorldObject, cell: Cell) -> Shape:
    """The box around all shapes of an object, along the axes of the first.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when it has no shapes, or a plane.
    """
    if not obj.shapes or any(isinstance(shape.geometry, Plane) for shape in obj.shapes):
        raise StepFailed(
            "INVALID_OBJECT_NAME", f"'{obj.name}' has no shape to hold: give a `grasp_pose`"
        )
    axes = SE3(obj.shapes[0].pose.rotation, np.zeros(3))
    corners = axes.inverse().apply(cell.scene.corners(obj.name))
    low, high = corners.min(axis=0), corners.max(axis=0)
    width, depth, height = (float(length) for length in high - low)
    return Shape(Box((width, depth, height)), axes @ SE3(np.eye(3), (low + high) / 2))


def align(
    approach: FloatArray, closing: FloatArray, target_approach: FloatArray, side: FloatArray
) -> FloatArray:
    """Rotation that takes the TCP's approach and closing axes to directions in the world."""
    in_tcp = np.column_stack([approach, closing, np.cross(approach, closing)])
    in_world = np.column_stack([target_approach, side, np.cross(target_approach, side)])
    return in_world @ in_tcp.T
