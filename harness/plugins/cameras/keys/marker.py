"""The key `marker` of a shape: an ArUco marker, a white plate on which black cells stand out.

Planner and physics know the plate; whatever draws boxes draws the marker, without any texture.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false

from __future__ import annotations

from itertools import groupby
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from harness.core.extras import absent_package
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.language.base import Count, PositiveLength, SpecModel
from harness.language.world import ShapeKey

THICKNESS = 0.001  # Of the plate [m]
INK = 0.0002  # Thickness of the black boxes, half of it above the plate [m]

WHITE, BLACK = (0.95, 0.95, 0.95, 1.0), (0.03, 0.03, 0.03, 1.0)

MarkerDictionary = Literal[
    "DICT_4X4_50",
    "DICT_4X4_100",
    "DICT_4X4_250",
    "DICT_4X4_1000",
    "DICT_5X5_50",
    "DICT_5X5_100",
    "DICT_5X5_250",
    "DICT_5X5_1000",
    "DICT_6X6_50",
    "DICT_6X6_100",
    "DICT_6X6_250",
    "DICT_6X6_1000",
    "DICT_7X7_50",
    "DICT_7X7_100",
    "DICT_7X7_250",
    "DICT_7X7_1000",
    "DICT_ARUCO_ORIGINAL",
    "DICT_APRILTAG_16h5",
    "DICT_APRILTAG_25h9",
    "DICT_APRILTAG_36h10",
    "DICT_APRILTAG_36h11",
]
ODD_COUNTS = {
    "DICT_ARUCO_ORIGINAL": 1024,
    "DICT_APRILTAG_16h5": 30,
    "DICT_APRILTAG_25h9": 35,
    "DICT_APRILTAG_36h10": 2320,
    "DICT_APRILTAG_36h11": 587,
}


def marker_count(dictionary: str) -> int:
    """How many markers a dictionary has; of most the name says it."""
    return ODD_COUNTS.get(dictionary) or int(dictionary.rsplit("_", 1)[1])


class MarkerName(SpecModel):
    """An ArUco marker by its dictionary and number."""

    short = "id"

    id: Annotated[Count, Field(ge=0)] = Field(
        description="The number of the marker in its dictionary."
    )
    dictionary: MarkerDictionary = Field(
        default="DICT_4X4_50", description="The dictionary of the marker, by OpenCV's name."
    )

    @model_validator(mode="after")
    def _is_in_the_dictionary(self) -> MarkerName:
        count = marker_count(self.dictionary)
        if self.id >= count:
            raise ValueError(f"{self.dictionary} has the markers 0 to {count - 1}, not {self.id}")
        return self


class MarkerSpec(MarkerName, ShapeKey):
    """A printed ArUco marker on a white plate of 1 mm; it faces +z of its pose, its top is +y.

    It needs the extra `cameras`.
    """

    key: ClassVar[str] = "marker"
    short = ""

    size: PositiveLength = Field(description="The side of the black square [m].")
    margin: PositiveLength | None = Field(
        default=None,
        description="The width of the white border [m]; the default is one of its cells.",
    )

    def solid(self) -> Box:
        """The plate: a box centred on the marker's pose."""
        from harness.world.objects import ObjectUnusableError

        if missing := absent_package("cv2"):
            raise ObjectUnusableError(f"its marker cannot be drawn: {missing}")
        margin = self.size / len(_cells(self)) if self.margin is None else self.margin
        side = self.size + 2 * margin
        return Box((side, side, THICKNESS))

    def printed(self, pose: SE3, name: str) -> tuple[Shape, ...]:
        """The plate, then its black parts."""
        cells = _cells(self)
        side = self.size / len(cells)
        shapes = [Shape(self.solid(), pose, WHITE, name)]
        for top, bottom, left, right in _black_rectangles(cells):
            x = ((left + right) / 2 - len(cells) / 2) * side
            y = (len(cells) / 2 - (top + bottom) / 2) * side
            box = Box(((right - left) * side, (bottom - top) * side, INK))
            centre = SE3(np.eye(3), np.array([x, y, THICKNESS / 2]))
            shapes.append(Shape(box, pose @ centre, BLACK))
        return tuple(shapes)


def _cells(marker: MarkerName) -> np.ndarray:
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
