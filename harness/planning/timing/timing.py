"""Gives a path its times: a trapezoid on a straight line, TOPP-RA through waypoints."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import ruckig

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.timing.limits import Limits as Limits
from harness.planning.timing.limits import TimingError as TimingError
from harness.planning.timing.limits import sampled_within_limits, slowed_to_limits, within_limits
from harness.planning.timing.profiles import Trapezoid, on_grid, resting, straight_curve
from harness.planning.timing.toppra_solver import fastest

GRID_POINTS_PER_PIECE = 20
"""TOPP-RA's grid points on each line and blend; fewer break the limits in between."""

_AT_REST = 1e-9  # [rad] paths shorter than this have nowhere to go
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


@dataclass(frozen=True, eq=False)
class JerkLimited:
    """A motion from 0 to 1, without velocity and acceleration at both ends, on the time grid.

    Attributes:
        duration: The duration, a whole multiple of `GRID` [s].
    """

    duration: float
    _trajectory: ruckig.Trajectory

    @classmethod
    def fastest(cls, velocity: float, acceleration: float, jerk: float) -> JerkLimited:
        """The fastest profile under limits of the parameter's rate, acceleration and jerk.

        Raises:
            TimingError: Ruckig has no solution.

        References:
            L. Berscheid, T. Kroeger, "Jerk-limited Real-time Trajectory Generation with Arbitrary
            Target States", Robotics: Science and Systems, 2021.
        """
        problem = ruckig.InputParameter(1)
        problem.current_position, problem.target_position = [0.0], [1.0]
        problem.max_velocity, problem.max_acceleration = [velocity], [acceleration]
        problem.max_jerk = [jerk]
        found = ruckig.Trajectory(1)
        answer = ruckig.Ruckig(1).calculate(problem, found)
        if answer not in (ruckig.Result.Working, ruckig.Result.Finished):
            raise TimingError(f"Ruckig finds no motion under the jerk limit: {answer.name}")
        return cls(on_grid(found.duration), found)

    def __call__(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parameter, its rate and its acceleration at times (N,)."""
        share = self._trajectory.duration / self.duration
        inside = np.clip(times * share, 0.0, self._trajectory.duration)
        rows = np.array([self._trajectory.at_time(time) for time in inside]).reshape(-1, 3)
        return rows[:, 0], rows[:, 1] * share, rows[:, 2] * share**2


def time_straight(
    joint_names: tuple[str, ...], first: FloatArray, second: FloatArray, limits: Limits
) -> JointTrajectory:
    """Move on a straight joint-space line, all joints at once, as fast as the limits allow.

    Every joint's velocity is a trapezoid; under a jerk limit it is what Ruckig makes of it.

    Raises:
        TimingError: The limits cannot be kept.
    """
    span = np.abs(second - first)
    if np.linalg.norm(span) < _AT_REST:
        return resting(joint_names, first)
    moving = span > 1e-12
    velocity = float(np.min(limits.velocity[moving] / span[moving]))
    acceleration = float(np.min(limits.acceleration[moving] / span[moving]))
    if np.isfinite(limits.jerk):
        jerk = limits.jerk / float(span.max())
        profile = JerkLimited.fastest(velocity, acceleration, jerk)
    else:
        profile = Trapezoid.fastest(1.0, velocity, acceleration)
    line = straight_curve(first, second, profile)
    curve, total = slowed_to_limits(line, profile.duration, limits)
    trajectory = sampled_within_limits(joint_names, curve, total, limits)
    trajectory.positions[-1] = second
    return trajectory


def time_stopping(
    joint_names: tuple[str, ...], waypoints: FloatArray, limits: Limits
) -> JointTrajectory:
    """Move along a polyline exactly, at rest at every waypoint."""
    pieces = [
        time_straight(joint_names, first, second, limits) for first, second in pairwise(waypoints)
    ]
    return joined(pieces)


def joined(pieces: Sequence[JointTrajectory]) -> JointTrajectory:
    """One trajectory after the other, each beginning at rest where the previous one ends."""
    times, offset = [pieces[0].times], pieces[0].duration
    for piece in pieces[1:]:
        times.append(piece.times[1:] + offset)
        offset += piece.duration
    rest = [slice(None), *[slice(1, None)] * (len(pieces) - 1)]
    columns: list[FloatArray] = [
        np.concatenate(
            [getattr(piece, name)[part] for piece, part in zip(pieces, rest, strict=True)]
        )
        for name in ("positions", "velocities", "accelerations")
    ]
    return JointTrajectory(pieces[0].joint_names, np.concatenate(times), *columns)


def time_blended(
    joint_names: tuple[str, ...], waypoints: FloatArray, limits: Limits, deviation: float
) -> JointTrajectory:
    """Move along a polyline with rounded corners as fast as the limits allow, timed by TOPP-RA.

    Args:
        joint_names: The joint names of the columns.
        waypoints: The waypoints, shape (N, dof), N > 2.
        limits: Kept on every 2 ms sample: the times are stretched where TOPP-RA exceeds them.
        deviation: Largest joint-space distance from a corner [rad].

    Raises:
        TimingError: TOPP-RA has no solution.
    """
    path = BlendedPath(waypoints, deviation)
    timed, duration = fastest(path, limits, _grid(path))
    curve, total = within_limits(timed, duration, limits)
    trajectory = sampled_within_limits(joint_names, curve, total, limits)
    trajectory.positions[0], trajectory.positions[-1] = waypoints[0], waypoints[-1]
    return trajectory


def _grid(path: BlendedPath) -> FloatArray:
    """TOPP-RA's grid points: evenly on every line and blend."""
    grid = np.unique(
        np.concatenate(
            [
                np.linspace(low, high, GRID_POINTS_PER_PIECE + 1)
                for low, high in zip(path.breaks[:-1], path.breaks[1:], strict=True)
                if high - low > 1e-9
            ]
        )
    )
    grid = grid[np.concatenate([[True], np.diff(grid) > 1e-10])]
    grid[0], grid[-1] = 0.0, path.length
    return grid
