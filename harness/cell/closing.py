"""Where the fingers are when they have closed on an object, and what they meet before."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from harness.cell.cell import Cell
from harness.cell.grasping import gripper_axes, position_for_width
from harness.core.types import FloatArray
from harness.ports.scene import Touch

DOWN = 0.7
"""Least share of a downward motion in an approach that counts as one from above: 45 degrees."""


def position_around(name: str, state: FloatArray, cell: Cell) -> float:
    """Position of the gripper's joint at which the fingers meet an object in the scene.

    Its width is that of the boxes around its shapes, along the closing axis of the hand.

    Args:
        state: The whole robot, description order.
    """
    if cell.gripper.cups:
        return cell.gripper.closed_position
    tcp = cell.kinematics.link_pose(state, cell.description.tcp_link)
    axis = tcp.rotation @ gripper_axes(cell)[1]
    across = cell.frame(name).apply(cell.scene.corners(name)) @ axis
    return position_for_width(cell.gripper, float(np.ptp(across)))


def closing_obstacles(name: str, state: FloatArray, cell: Cell) -> list[Touch]:
    """What the hand penetrates when it has closed to the width of an object, deepest first."""
    hand = cell.gripper
    if hand.cups:
        return []
    closed = np.array(state)
    closed[cell.description.joint_index[hand.joint]] = position_around(name, state, cell)
    links = {hand.palm_link, *hand.links}
    touches = cell.scene.touches(cell.description.with_mimics(closed))
    return [
        touch
        for touch in touches
        if touch.distance < 0 and name not in (bodies := {touch.first, touch.second})
        if bodies & links and bodies & set(cell.presence)
    ]


def higher_grasp(obstacles: Sequence[Touch], cell: Cell) -> str:
    """`5 mm higher`: the way against the approach on which closed fingers leave what they meet."""
    tcp = cell.frame(cell.description.tcp_link)
    from_above = float((tcp.rotation @ gripper_axes(cell)[0])[2]) < -DOWN
    way = "higher" if from_above else "farther back, against the approach,"
    if not obstacles:
        return way
    depth = max(-touch.distance for touch in obstacles)
    return f"{math.ceil(1e3 * depth) + 1} mm {way}"  # a millimetre of room
