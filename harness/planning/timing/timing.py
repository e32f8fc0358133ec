"""Gives a path its times: a trapezoid on a straight line, TOPP-RA through waypoints."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.timing.cubic_spline import PiecewiseCubic
from harness.planning.timing.limits import Limits as Limits
from harness.planning.timing.limits import TimingError as TimingError
from harness.planning.timing.limits import joint_motion, sampled_within_limits
from harness.planning.timing.profiles import JerkLimited, Trapezoid, resting, straight_curve
from harness.planning.timing.toppra_solver import fastest

POINTS_PER_PIECE = 20
"""TOPP-RA's grid points on each line and blend; fewer break the limits in between."""

_AT_REST = 1e-9  # [rad] paths shorter than this have nowhere to go
_LARGEST_SHARE = 0.45  # of a segment that one blend may take
_ROUNDING = 1e-12  # [rad] parameters that near below a break count as at it


class BlendedPath:
    """Straight segments joined by parabolic blends.

    Within `reach` of a corner (measured along both segments) the path is the parabola tangent to
    both; it leaves the corner by at most a quarter of `reach` times the change of direction.

    Attributes:
        breaks: Parameters at which lines and blends meet, shape (K,), from 0 to `length`.
        length: The length of the polyline, the range of the parameter [rad].
        ends: The first and the last waypoint, shape (2, dof).
    """

    def __init__(self, waypoints: FloatArray, deviation: float) -> None:
        """Round the corners of waypoints (N, dof), with at most `deviation` from them [rad]."""
        segments = np.diff(waypoints, axis=0)
        lengths = np.linalg.norm(segments, axis=1)
        directions = segments / lengths[:, None]
        knots = np.concatenate([[0.0], np.cumsum(lengths)])
        self.length = float(knots[-1])
        self.ends = waypoints[[0, -1]]
        turns = np.diff(directions, axis=0)
        changes = np.linalg.norm(turns, axis=1)
        room = _LARGEST_SHARE * np.minimum(lengths[:-1], lengths[1:])
        reaches = np.minimum(room, 4 * deviation / np.maximum(changes, 1e-9))
        corners, reach = knots[1:-1], reaches[:, None]
        bends = np.zeros((2 * len(segments) - 1, waypoints.shape[1]))
        bends[1::2] = turns / (2 * reach)
        entries = waypoints[1:-1] - reach * directions[:-1]
        self.breaks = np.concatenate(
            [[0.0], _alternating(corners - reaches, corners + reaches), [self.length]]
        )
        origins = np.column_stack(
            [_alternating(knots[:-1], corners), _alternating(np.zeros(len(segments)), reaches)]
        )
        coefficients = (
            np.zeros_like(bends),
            0.5 * bends,
            _alternating(directions, directions[:-1]),
            _alternating(waypoints[:-1], entries),
        )
        domain = -np.inf, np.inf, _ROUNDING
        self.cubics = PiecewiseCubic(self.breaks, origins, coefficients, domain)

    def grid(self) -> FloatArray:
        """Points for TOPP-RA: evenly on every line and blend, shape (M,)."""
        first, last = self.breaks[:-1], self.breaks[1:]
        has_length = last - first > 1e-9
        grid = np.unique(np.linspace(first[has_length], last[has_length], POINTS_PER_PIECE + 1))
        grid = grid[np.concatenate([[True], np.diff(grid) > 1e-10])]
        grid[0], grid[-1] = 0.0, self.length
        return grid

    def blends(self) -> FloatArray:
        """Five positions of each blend, its ends included, shape (B, 5, dof)."""
        first, last = self.breaks[1:-1:2], self.breaks[2:-1:2]
        places = np.linspace(first, last, 5, axis=1)
        return self.cubics.evaluate(places.ravel())[0].reshape(*places.shape, -1)


def _alternating(first: FloatArray, second: FloatArray) -> FloatArray:
    """Rows of two arrays in turn; the first array may have one row more."""
    found = np.empty((len(first) + len(second), *first.shape[1:]))
    found[::2], found[1::2] = first, second
    return found


def time_straight(
    joint_names: tuple[str, ...], first: FloatArray, second: FloatArray, limits: Limits
) -> JointTrajectory:
    """Move on a straight joint-space line, all joints at once, as fast as the limits allow.

    Every joint's velocity is a trapezoid; under a jerk limit its acceleration is.

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
    motion = joint_motion(line, profile.duration)
    trajectory = sampled_within_limits(joint_names, motion, profile.duration, limits)
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
    joint_names: tuple[str, ...], path: BlendedPath, limits: Limits
) -> JointTrajectory:
    """Move along a polyline with rounded corners as fast as the limits allow, timed by TOPP-RA.

    Args:
        limits: Kept on every set point: the times are stretched where TOPP-RA exceeds them.

    Raises:
        TimingError: TOPP-RA has no solution.
    """
    curve, total = fastest(path.cubics, limits, path.grid())
    motion = joint_motion(curve, total)
    trajectory = sampled_within_limits(joint_names, motion, total, limits)
    trajectory.positions[[0, -1]] = path.ends
    return trajectory
