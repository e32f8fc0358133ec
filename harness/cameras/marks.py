"""Marks in pictures: a goal's frame, and a line to it."""

from __future__ import annotations

import numpy as np

from harness.core.geometry import Capsule, Rgba, Shape
from harness.core.spatial import SE3, rotation_from_rpy
from harness.core.types import FloatArray
from harness.core.world import WorldObject

GOAL, LINE = "goal of the failed step", "from the nearest pose to the goal"
"""Names of the marks' bodies, which objects of a scenario are unlikely to have."""

AXIS_LENGTH, AXIS_RADIUS = 0.12, 0.006  # of the goal's frame [m]
RED, GREEN, BLUE = (0.85, 0.1, 0.1, 1.0), (0.1, 0.6, 0.1, 1.0), (0.1, 0.2, 0.85, 1.0)
ORANGE: Rgba = (0.95, 0.45, 0.05, 1.0)

SHORTEST_LINE = 0.005  # shorter lines are not visible [m]


def frame_mark(pose: SE3, length: float = AXIS_LENGTH) -> WorldObject:
    """The axes x, y, z of a goal in red, green, blue, of a length [m]."""
    half, radius = 0.5 * length, AXIS_RADIUS * length / AXIS_LENGTH
    turns = ((0, np.pi / 2, 0), (-np.pi / 2, 0, 0), (0, 0, 0))
    axes = [
        Shape(
            Capsule(radius, length),
            SE3(rotation_from_rpy(turn), rotation_from_rpy(turn) @ np.array([0.0, 0.0, half])),
            rgba,
        )
        for turn, rgba in zip(turns, (RED, GREEN, BLUE), strict=True)
    ]
    return mark(GOAL, pose, *axes)


def line_mark(here: FloatArray, there: FloatArray) -> WorldObject | None:
    """An orange line between two points of the world; None for a line that is too short."""
    away = float(np.linalg.norm(there - here))
    if away <= SHORTEST_LINE:
        return None
    along = Shape(Capsule(0.003, away), rgba=ORANGE)
    return mark(LINE, SE3(_along(there - here), 0.5 * (there + here)), along)


def mark(name: str, pose: SE3, *shapes: Shape) -> WorldObject:
    """A body of shapes for pictures."""
    return WorldObject(name, shapes, pose, True, 0.0, np.zeros(3), np.zeros((3, 3)))


def _along(direction: FloatArray) -> FloatArray:
    """A rotation whose z axis points along a direction."""
    z = direction / np.linalg.norm(direction)
    other = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(other, z) / np.linalg.norm(np.cross(other, z))
    return np.stack([x, np.cross(z, x), z], axis=1)
