"""Limits of the joints, and how much slower a motion must be to keep them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.details import Details
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.collision.native.library import call
from harness.planning.efforts import InverseDynamics
from harness.planning.timing.profiles import (
    GRID,
    SAMPLE_PERIOD,
    Curve,
    on_grid,
    sample,
    smoothed,
)
from harness.recording.motion_failures import TrajectoryFailure

EFFORT_SAMPLES = 2
"""Efforts are computed at every second set point, 20 ms apart: they change slowly."""

SMOOTHED_PERIODS = 3
"""Periods between set points over which jumps of the acceleration are spread: over two of them the
cubic still exceeds it."""

_MOST_STRETCHES = 60  # attempts; few motions need more than five

SmoothedOver = Callable[[float], Curve]
"""A motion smoothed over a window [s], by which it lasts longer; 0 for the motion as it is."""


class TimingError(Exception):
    """A path cannot be given times under the limits."""

    def __init__(self, message: str, details: Details | None = None) -> None:
        super().__init__(message)
        self.details = details or Details.of(TrajectoryFailure("timing"))


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of the joints, scaling included; shape (dof,) each.

    Attributes:
        velocity: The velocity limits; never infinite.
        acceleration: The acceleration limits; never infinite.
        commanded: The accelerations of the joints without scaling, which the commands between the
            set points of a trajectory keep as well; inf where nothing interpolates.
        dynamics: The dynamics of the efforts; None where the robot gives no effort limits.
    """

    velocity: FloatArray
    acceleration: FloatArray
    commanded: FloatArray
    jerk: float = np.inf
    dynamics: InverseDynamics | None = None

    @classmethod
    def scaled(
        cls, velocity: FloatArray, acceleration: FloatArray, velocity_scaling: float, accel: float
    ) -> Limits:
        """Joint limits times the scaling factors; unlimited velocities count as 2 pi rad/s."""
        bounded = np.where(np.isfinite(velocity), velocity, 2 * np.pi)
        return cls(bounded * velocity_scaling, acceleration * accel, acceleration)

    def excess(self, trajectory: JointTrajectory) -> tuple[float, float]:
        """How many times slower the cubics between set points, and they themselves, must be.

        At most 1 where they keep the limits.
        """
        states = trajectory.positions, trajectory.velocities, trajectory.accelerations
        given = trajectory.times, *states, self.velocity, self.acceleration, self.commanded
        fast, hard, between = call("largest_shares", given, np.empty(3)).tolist()
        return math.sqrt(between), max(fast, math.sqrt(hard))

    def effort_excess(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> float:
        """How many times slower states (N, dof) must be for their efforts; at most 1 if they fit.

        Raises:
            TimingError: Standing still takes too much effort already.
        """
        states = positions, velocities, accelerations
        if self.dynamics is None or self.dynamics.are_clearly_within(1.0, *states):
            return 0.0
        limits = self.dynamics.limits
        total = self.dynamics.efforts(*states)
        if np.all(np.abs(total) <= limits):
            return 0.0
        still = np.zeros_like(positions)
        standing = self.dynamics.efforts(positions, still, still)
        room = limits - np.sign(total - standing) * standing
        if np.any(room <= 0):
            raise TimingError(*self.dynamics.standing_overload(positions))
        return float(np.sqrt(np.max(np.abs(total - standing) / room)))


def sampled_within_limits(
    joint_names: tuple[str, ...],
    smoothed_over: SmoothedOver,
    duration: float,
    limits: Limits,
    link_excess: Callable[[JointTrajectory], float] = lambda _: 0.0,
) -> JointTrajectory:
    """Set points of a motion, run more slowly until they and the commands between them keep limits.

    A controller interpolates set points by cubics. Where the acceleration of the motion jumps
    between two of them, the cubic accelerates up to 1.5 times as much. Such a motion is first
    smoothed over the periods between set points, and one whose jerk is too large over a longer
    window; then it is slowed by what remains.

    Args:
        smoothed_over: The motion, at rest at both ends.
        duration: Its duration without smoothing [s].
        link_excess: How many times slower the set points must be for other limits.

    Raises:
        TimingError: Neither smoothing nor slowing helps.
    """
    window, length, total = 0.0, duration, on_grid(duration)
    curve, excess = smoothed_over(window), np.inf
    for _ in range(_MOST_STRETCHES):
        trajectory = sample(joint_names, stretched(curve, length, total), total)
        between, at_points = limits.excess(trajectory)
        needed = _smoothing(trajectory, limits, window, between)
        if needed > window:
            slower, window, length = total / length, needed, duration + needed
            curve, total = smoothed_over(window), on_grid(slower * length)
            continue
        excess = max(between, at_points, link_excess(trajectory))
        if excess <= 1.0 + 1e-9:
            states = trajectory.positions, trajectory.velocities, trajectory.accelerations
            excess = limits.effort_excess(*(rows[::EFFORT_SAMPLES] for rows in states))
        if excess <= 1.0 + 1e-9:
            return trajectory
        total = on_grid(max(total * excess, total + GRID))
    raise TimingError(f"the limits are exceeded {excess:.3g} times however slow the motion is")


def joint_motion(curve: Curve, duration: float) -> SmoothedOver:
    """A motion whose joints are smoothed each by itself."""
    return lambda window: smoothed(curve, duration, window) if window else curve


def _smoothing(trajectory: JointTrajectory, limits: Limits, window: float, between: float) -> float:
    """The window [s] over which a motion, smoothed over another one now, is to be smoothed."""
    if np.isfinite(limits.jerk):
        rest = np.zeros_like(trajectory.accelerations[:1])
        inner = np.concatenate([rest, trajectory.accelerations[1:-1], rest])
        steps = np.diff(trajectory.times)[:, None]
        jerk = float(np.abs(np.diff(inner, axis=0) / steps).max())
        if jerk > limits.jerk * (1 + 1e-9):
            ramp = float(np.abs(trajectory.accelerations).max()) / limits.jerk
            wider = min(window * jerk / limits.jerk, 2.0 * window)
            return on_grid(max(wider, window + GRID) if window else ramp)
    return max(window, SMOOTHED_PERIODS * SAMPLE_PERIOD) if between > 1.0 + 1e-9 else window


def stretched(curve: Curve, duration: float, total: float) -> Curve:
    """A curve run in another time [s]."""
    factor = duration / total

    def slowed(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        positions, velocities, accelerations = curve(np.minimum(times * factor, duration))
        return positions, velocities * factor, accelerations * factor**2

    return slowed
