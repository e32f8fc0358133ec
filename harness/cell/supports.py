"""Places on top of an object for another one, the middle first."""

from __future__ import annotations

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.recording.explanation import Explanation

PLACES_ALONG_SIDE = 5  # along each side of a top, from edge to edge
LEVEL = np.cos(np.radians(2.0))  # cosine of the tilt of a top on which things stand
SAME_HEIGHT = 1e-3  # [m] between the tops of the shapes of one top


def places_on(name: str, support: str, cell: Cell) -> list[SE3]:
    """T_world_object of an upright object on the top of another, nearest to its middle first.

    The box around the object stays within the top's sides, where it is smaller. The object has the
    heading of the support.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when the support has no shape, or is tilted.
    """
    frame = cell.frame(support)
    if support not in cell.scene.object_names():
        raise _no_top(support, "is not in the planning scene")
    if frame.rotation[2, 2] < LEVEL:
        raise _no_top(support, "is tilted")
    low, high = top_of(cell.scene.corners(support))
    corners = cell.scene.corners(name)
    least, most = corners.min(axis=0), corners.max(axis=0)
    room = np.maximum(high - low - (most - least), 0.0)[:2]
    middle = 0.5 * (low + high - least - most)
    height = high[2] - least[2]
    shares = np.linspace(-0.5, 0.5, PLACES_ALONG_SIDE)
    offsets = {(float(x * room[0]), float(y * room[1])) for x in shares for y in shares}
    ordered = sorted(offsets, key=lambda offset: (round(float(np.hypot(*offset)), 6), offset))
    return [
        frame @ SE3(np.eye(3), np.array([middle[0] + x, middle[1] + y, height])) for x, y in ordered
    ]


def top_of(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least and largest corner of the shape with the largest top, of those that are highest.

    Args:
        corners: Eight corners of each shape, shape (8 n, 3) [m].
    """
    boxes = corners.reshape(-1, 8, 3)
    low, high = boxes.min(axis=1), boxes.max(axis=1)
    is_top = high[:, 2] > high[:, 2].max() - SAME_HEIGHT
    area = np.prod((high - low)[:, :2], axis=1)
    widest = int(np.argmax(np.where(is_top, area, -1.0)))
    return low[widest], high[widest]


def _no_top(support: str, why: str) -> StepFailed:
    advice = "give the `pose` at which the object will stand, in place of `on`"
    return StepFailed(
        "INVALID_OBJECT_NAME",
        f"'{support}' {why}, so it has no top to put something on",
        Explanation(advice=advice),
    )
