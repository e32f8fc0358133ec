"""YAML files of ROS, whose numbers may have tags for units."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from harness.language.files.source import Place, Scalar, Source
from harness.language.files.yaml_file import Composer

UNITS = {
    "!radians": 1.0,
    "!degrees": math.pi / 180,
    "!meters": 1.0,
    "!millimeters": 0.001,
    "!foot": 0.3048,
    "!inches": 0.0254,
}
"""Tags with their unit in radians or metres."""


class UnitComposer(Composer):
    """Composes YAML with the tags of UNITS."""

    tags = UNITS

    def __init__(self, source: Source, number: Callable[[str], float]) -> None:
        """Compose values of a source.

        Args:
            number: The number of a text after a tag, or a ValueError.
        """
        super().__init__(source)
        self._number = number

    def _scalar(self, event: Any, place: Place) -> Scalar:
        if event.tag not in UNITS:
            return super()._scalar(event, place)
        try:
            return self._number(str(event.value)) * UNITS[event.tag]
        except ValueError as error:
            self.problems.append(place.problem(str(error)))
            return 0
