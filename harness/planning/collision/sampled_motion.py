"""A motion of a group along a polyline in joint space, as states at equal distances."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray

COUNTED_RESOLUTION = 1 / 32
"""Joint-space distance between the states that are counted: of motions that are checked more finely
most states are certified by others [rad]."""


@dataclass(eq=False)
class SampledMotion:
    """States along a polyline, evenly spaced from corner to corner; its start is not one of them.

    Attributes:
        corners: Group positions at the corners and at both ends, shape (C, dof), C > 1.
        places: The states at the corners, shape (C,): -1 at the start, rising to the last state.
        spacing: The largest joint-space distance between two states along the polyline [rad].
    """

    corners: FloatArray
    places: FloatArray
    spacing: float

    @staticmethod
    def of(path: FloatArray, metric: FloatArray, resolution: float) -> SampledMotion:
        """The states of a path."""
        lengths = np.linalg.norm(np.diff(path, axis=0) * metric, axis=1)
        counts = np.maximum(1.0, np.ceil(lengths / resolution))
        places = np.append(0.0, np.cumsum(counts)) - 1.0
        return SampledMotion(path, places, float((lengths / counts).max()))

    @property
    def last(self) -> int:
        """The number of the last state; the first one has the number 0."""
        return int(self.places[-1])

    @property
    def counted(self) -> int:
        """The number of states; at most one every `COUNTED_RESOLUTION`."""
        count = self.last + 1
        if self.spacing >= COUNTED_RESOLUTION:
            return count
        return max(1, min(count, math.ceil(count * self.spacing / COUNTED_RESOLUTION)))

    def states(self) -> FloatArray:
        """Group positions at the start and at each state, shape (1 + `last` + 1, dof)."""
        numbers = np.arange(-1, self.last + 1)
        columns = [np.interp(numbers, self.places, column) for column in self.corners.T]
        return np.stack(columns, axis=1)

    def row(self, state: int) -> float:
        """Where a state is: 1.25 is a quarter of the way from the second corner to the third."""
        row = bisect_right(self.places, state, 1, len(self.places) - 1) - 1
        here, there = self.places[row : row + 2].tolist()
        return row + (state - here) / (there - here)

    def state(self, number: int) -> FloatArray:
        """Group positions at a state."""
        row = self.row(number)
        corner = min(int(row), len(self.corners) - 2)
        step = self.corners[corner + 1] - self.corners[corner]
        return self.corners[corner] + step * (row - corner)
