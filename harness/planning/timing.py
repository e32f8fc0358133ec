"""Gives a path its times: a trapezoid on a straight line, TOPP-RA through waypoints."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.blended_path import BlendedPath
from harness.planning.profiles import (
    GRID,
    Curve,
    Trapezoid,
    on_grid,
    resting,
    sample,
    straight_curve,
)

GRID_POINTS_PER_PIECE = 20
"""TOPP-RA's grid points on each line and blend; fewer break the limits in between."""

_MOST_STRETCHES = 20
_STILL = 1e-9  # [rad] paths shorter than this have nowhere to go


class TimingError(Exception):
    """A path cannot be given times under the limits."""


@dataclass(frozen=True, eq=False)
class Limits:
    """What the joints may do, scaling included; shape (dof,) each, never infinite."""

    velocity: FloatArray
    acceleration: FloatArray

    @classmethod
    def scaled(
        cls, velocity: FloatArray, acceleration: FloatArray, velocity_scaling: float, accel: float
    ) -> Limits:
        """Joint limits times the scaling factors; unlimited velocities count as 2 pi rad/s."""
        bounded = np.where(np.isfinite(velocity), velocity, 2 * np.pi)
        return cls(bounded * velocity_scaling, acceleration * accel)

    def excess(self, velocities: FloatArray, accelerations: FloatArray) -> float:
        """How many times slower a motion (N, dof) must be; below 1 when it keeps both."""
        fast = float(np.max(np.abs(velocities) / self.velocity))
        hard = float(np.sqrt(np.max(np.abs(accelerations) / self.acceleration)))
        return max(fast, hard)


def time_straight(
    joint_names: tuple[str, ...], first: FloatArray, second: FloatArray, limits: Limits
) -> JointTrajectory:
    """Move on a straight joint-space line, every joint's velocity a trapezoid, all at once."""
    span = np.abs(second - first)
    if np.linalg.norm(span) < _STILL:
        return resting(joint_names, first)
    moving = span > 1e-12
    velocity = float(np.min(limits.velocity[moving] / span[moving]))
    acceleration = float(np.min(limits.acceleration[moving] / span[moving]))
    profile = Trapezoid.fastest(1.0, velocity, acceleration)
    return sample(joint_names, straight_curve(first, second, profile), profile.duration)


def time_stopping(
    joint_names: tuple[str, ...], waypoints: FloatArray, limits: Limits
) -> JointTrajectory:
    """Move along a polyline exactly, at rest at every waypoint."""
    pieces = [
        time_straight(joint_names, first, second, limits) for first, second in pairwise(waypoints)
    ]
    times, offset = [pieces[0].times], pieces[0].duration
    for piece in pieces[1:]:
        times.append(piece.times[1:] + offset)
        offset += piece.duration
    rest = [slice(None), *[slice(1, None)] * (len(pieces) - 1)]
    joined: list[FloatArray] = [
        np.concatenate(
            [getattr(piece, name)[part] for piece, part in zip(pieces, rest, strict=True)]
        )
        for name in ("positions", "velocities", "accelerations")
    ]
    return JointTrajectory(joint_names, np.concatenate(times), *joined)


def time_blended(
    joint_names: tuple[str, ...], waypoints: FloatArray, limits: Limits, deviation: float
) -> JointTrajectory:
    """Move along a polyline as fast as the limits let, its corners rounded, timed by TOPP-RA.

    Args:
        joint_names: Of the columns.
        waypoints: Shape (N, dof), N > 2.
        limits: Kept on every 2 ms sample: the times are stretched where TOPP-RA exceeds them.
        deviation: Largest joint-space distance from a corner [rad].

    Raises:
        TimingError: TOPP-RA has no solution.

    References:
        H. Pham, Q.-C. Pham, "A New Approach to Time-Optimal Path Parameterization Based on
        Reachability Analysis", IEEE T-RO 34(3), 2018.
    """
    path = BlendedPath(waypoints, deviation)
    timed, duration = _toppra(path, limits)
    curve, total = slowed_to_limits(timed, duration, limits)
    trajectory = sample(joint_names, curve, total)
    trajectory.positions[0], trajectory.positions[-1] = waypoints[0], waypoints[-1]
    return trajectory


def slowed_to_limits(curve: Curve, duration: float, limits: Limits) -> tuple[Curve, float]:
    """A curve run more slowly, until every sample of the time grid keeps the limits.

    Returns:
        The slower curve and its duration, a whole multiple of the grid [s].

    Raises:
        TimingError: Stretching does not help: the curve is not smooth enough.
    """
    total, excess = on_grid(duration), np.inf
    for _ in range(_MOST_STRETCHES):
        factor = duration / total

        def slowed(
            times: FloatArray, factor: float = factor
        ) -> tuple[FloatArray, FloatArray, FloatArray]:
            positions, velocities, accelerations = curve(np.minimum(times * factor, duration))
            return positions, velocities * factor, accelerations * factor**2

        grid: FloatArray = np.arange(round(total / GRID) + 1, dtype=np.float64) * GRID
        _, velocities, accelerations = slowed(grid)
        excess = limits.excess(velocities, accelerations)
        if excess <= 1.0 + 1e-9:
            return slowed, total
        total = on_grid(max(total * excess, total + GRID))
    raise TimingError(f"the limits are exceeded {excess:.3g} times however slow the motion is")


def _toppra(path: BlendedPath, limits: Limits) -> tuple[Curve, float]:
    """TOPP-RA's solution as a curve over time, and its duration [s]."""
    with warnings.catch_warnings():  # its first import has invalid escapes of its own
        warnings.simplefilter("ignore")
        import toppra as ta
        from toppra import algorithm, constraint
        from toppra.interpolator import AbstractGeometricPath
    logging.getLogger("toppra").setLevel(logging.CRITICAL)

    class Geometry(AbstractGeometricPath):
        def __call__(self, path_positions: Any, order: int = 0) -> FloatArray:
            values = path.evaluate(path_positions)[order]
            return values[0] if np.ndim(path_positions) == 0 else values

        @property
        def dof(self) -> int:
            return len(limits.velocity)

        @property
        def path_interval(self) -> FloatArray:
            return np.array([0.0, path.length])

        @property
        def waypoints(self) -> None:
            return None

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
    constraints = [
        constraint.JointVelocityConstraint(np.column_stack([-limits.velocity, limits.velocity])),
        constraint.JointAccelerationConstraint(
            np.column_stack([-limits.acceleration, limits.acceleration])
        ),
    ]
    solver = algorithm.TOPPRA(
        constraints, Geometry(), gridpoints=grid, parametrizer="ParametrizeConstAccel"
    )
    result = solver.compute_trajectory(0, 0)
    del ta
    if result is None:
        raise TimingError("TOPP-RA found no times under the limits")

    def timed(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        return result(times, 0), result(times, 1), result(times, 2)

    return timed, float(result.duration)
