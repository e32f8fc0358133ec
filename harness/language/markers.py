"""ArUco markers as files name them: OpenCV's dictionaries and a number in one of them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from harness.language.base import Count, PositiveLength, SpecModel

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


class MarkerSpec(MarkerName):
    """A printed ArUco marker on a white plate of 1 mm; it faces +z of its pose, its top is +y.

    It needs the extra `cameras`.
    """

    short = ""

    size: PositiveLength = Field(description="The side of the black square [m].")
    margin: PositiveLength | None = Field(
        default=None,
        description="The width of the white border [m]; the default is one of its cells.",
    )
