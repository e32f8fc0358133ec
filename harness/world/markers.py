"""An ArUco marker as boxes: a white plate, and the black cells standing out a little.

Planner and physics know the plate; whatever draws boxes draws the marker, without any texture.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false

from __future__ import annotations

from itertools import groupby

import numpy as np

from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.language.markers import MarkerSpec

THICKNESS = 0.001  # Of the plate [m]
INK = 0.0002  # Thickness of the black boxes, half of it above the plate [m]

WHITE, BLACK = (0.95, 0.95, 0.95, 1.0), (0.03, 0.03, 0.03, 1.0)


def plate(marker: MarkerSpec) -> Box:
    """The plate: a box centred on the marker's pose."""
    margin = marker.size / _cells(marker).shape[0] if marker.margin is None else marker.margin
    side = marker.size + 2 * margin
    return Box((side, side, THICKNESS))


def printed(marker: MarkerSpec, pose: SE3, name: str = "") -> tuple[Shape, ...]:
    """What the marker looks like: the plate, then its black parts.

    Args:
        pose: The pose T_object_marker of the marker.
    """
    cells = _cells(marker)
    side = marker.size / len(cells)
    shapes = [Shape(plate(marker), pose, WHITE, name)]
    for top, bottom, left, right in _black_rectangles(cells):
        x = ((left + right) / 2 - len(cells) / 2) * side
        y = (len(cells) / 2 - (top + bottom) / 2) * side
        box = Box(((right - left) * side, (bottom - top) * side, INK))
        centre = SE3(np.eye(3), np.array([x, y, THICKNESS / 2]))
        shapes.append(Shape(box, pose @ centre, BLACK))
    return tuple(shapes)


def _cells(marker: MarkerSpec) -> np.ndarray:
    """True where a cell is white, row 0 on top, the black border included."""
    import cv2  # here: few files have markers

    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, marker.dictionary))
    count = dictionary.markerSize + 2
    return np.asarray(cv2.aruco.generateImageMarker(dictionary, marker.id, count)) > 0


def _black_rectangles(white: np.ndarray) -> list[tuple[int, int, int, int]]:
    """Rectangles (top, bottom, left, right) that cover the black cells once each.

    Runs of a row; one that stands below an equal one makes it taller.
    """
    rectangles: list[tuple[int, int, int, int]] = []
    for row, line in enumerate(white.tolist()):
        column = 0
        for is_white, run in groupby(line):
            width = len(list(run))
            left, column = column, column + width
            if is_white:
                continue
            above = next((r for r in rectangles if r[1:] == (row, left, column)), None)
            if above is not None:
                rectangles.remove(above)
            rectangles.append((above[0] if above else row, row + 1, left, column))
    return rectangles
