"""A polyline with its corners rounded by parabolas, parametrised by length."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray

_LARGEST_SHARE = 0.45  # of a segment that one blend may take


class BlendedPath:
    """Straight segments joined by parabolic blends.

    Within `reach` of a corner (measured along both segments) the path is the parabola tangent to
    both; it leaves the corner by at most a quarter of `reach` times the change of direction.

    Attributes:
        breaks: Parameters at which lines and blends meet, shape (K,), from 0 to `length`.
        length: The length of the polyline, the range of the parameter [rad].
    """

    def __init__(self, waypoints: FloatArray, deviation: float) -> None:
        """Round the corners of waypoints (N, dof), with at most `deviation` from them [rad]."""
        self._waypoints = waypoints
        segments = np.diff(waypoints, axis=0)
        lengths = np.linalg.norm(segments, axis=1)
        self._directions = segments / lengths[:, None]
        self._knots = np.concatenate([[0.0], np.cumsum(lengths)])
        self.length = float(self._knots[-1])
        changes = np.linalg.norm(np.diff(self._directions, axis=0), axis=1)
        room = _LARGEST_SHARE * np.minimum(lengths[:-1], lengths[1:])
        self._reaches = np.minimum(room, 4 * deviation / np.maximum(changes, 1e-9))
        corners = self._knots[1:-1]
        self.breaks = np.sort(
            np.concatenate([[0.0, self.length], corners - self._reaches, corners + self._reaches])
        )

    def evaluate(self, parameter: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions and their first two derivatives, (M, dof) each, at parameters (M,).

        Where the second derivative jumps, its value is the limit from above (at the end: below).
        """
        s = np.atleast_1d(np.asarray(parameter, dtype=float))
        segment = np.clip(
            np.searchsorted(self._knots, s, side="right") - 1, 0, len(self._directions) - 1
        )
        direction = self._directions[segment]
        positions = self._waypoints[segment] + (s - self._knots[segment])[:, None] * direction
        first, second = direction.copy(), np.zeros_like(direction)
        for corner, reach in enumerate(self._reaches):
            at = self._knots[corner + 1]
            near = (s >= at - reach - 1e-12) & (s < at + reach - 1e-12)
            if not near.any() or reach < 1e-9:
                continue
            before, after = self._directions[corner], self._directions[corner + 1]
            u = (s[near] - at + reach)[:, None]
            bend = (after - before) / (2 * reach)
            entry = self._waypoints[corner + 1] - reach * before
            positions[near] = entry + u * before + 0.5 * u**2 * bend
            first[near] = before + u * bend
            second[near] = bend
        return positions, first, second
