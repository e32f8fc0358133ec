"""Limits of the joints, and how much slower a motion must be to keep them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from harness.core.details import Details
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.timing.profiles import GRID, SAMPLE_PERIOD, Curve, on_grid, sample, smoothed
from harness.recording.motion_failures import TrajectoryFailure

EFFORT_PERIOD = 10
"""Every so many samples of the time grid the efforts are computed: every 20 ms."""

SMOOTHED_PERIODS = 3
"""Periods between set points over which jumps of the acceleration are spread."""

_MOST_STRETCHES = 20


class TimingError(Exception):
    """A path cannot be given times under the limits.

    Attributes:
        details: The limit that is broken, and its numbers.
    """

    def __init__(self, message: str, details: Details | None = None) -> None:
        super().__init__(message)
        self.details = details or Details.of(TrajectoryFailure("timing"))


class Dynamics(Protocol):
    """Efforts that a motion takes, and those that the joints have."""

    limits: FloatArray
    joint_names: tuple[str, ...]

    def efforts(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> FloatArray:
        """Efforts of a motion, (N, dof) each."""
        ...

    def can_hold(self, positions: FloatArray) -> bool:
        """Whether the joints can hold the arm still at all positions, shape (N, dof)."""
        ...

    def standing_overload(
        self, positions: FloatArray, where: str = "on the way"
    ) -> tuple[str, Details]:
        """Message and details of a joint whose effort does not suffice to stand still, (N, dof)."""
        ...


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of the joints, scaling included; shape (dof,) each.

    Attributes:
        velocity: The velocity limits; never infinite.
        acceleration: The acceleration limits; never infinite.
        jerk: The jerk of every joint; inf for none.
        dynamics: The dynamics of the efforts; None where the robot gives no effort limits.
        commanded: The accelerations of the joints without scaling, which the commands between the
            set points of a trajectory keep as well; None where nothing interpolates.
    """

    velocity: FloatArray
    acceleration: FloatArray
    jerk: float = np.inf
    dynamics: Dynamics | None = None
    commanded: FloatArray | None = None

    @classmethod
    def scaled(
        cls, velocity: FloatArray, acceleration: FloatArray, velocity_scaling: float, accel: float
    ) -> Limits:
        """Joint limits times the scaling factors; unlimited velocities count as 2 pi rad/s."""
        bounded = np.where(np.isfinite(velocity), velocity, 2 * np.pi)
        return cls(bounded * velocity_scaling, acceleration * accel, commanded=acceleration)

    def excess(self, velocities: FloatArray, accelerations: FloatArray) -> float:
        """How many times slower a motion (N, dof) must be; below 1 when it keeps both."""
        fast = float(np.max(np.abs(velocities) / self.velocity))
        hard = float(np.sqrt(np.max(np.abs(accelerations) / self.acceleration)))
        return max(fast, hard)

    def effort_excess(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> float:
        """How many times slower a motion (N, dof) must be for its efforts; at most 1 when it is.

        Raises:
            TimingError: Standing still takes too much effort already.
        """
        if self.dynamics is None:
            return 0.0
        limits = self.dynamics.limits
        total = self.dynamics.efforts(positions, velocities, accelerations)
        if np.all(np.abs(total) <= limits):
            return 0.0
        still = np.zeros_like(positions)
        standing = self.dynamics.efforts(positions, still, still)
        room = limits - np.sign(total - standing) * standing
        if np.any(room <= 0):
            raise TimingError(*self.dynamics.standing_overload(positions))
        return float(np.sqrt(np.max(np.abs(total - standing) / room)))


def within_limits(curve: Curve, duration: float, limits: Limits) -> tuple[Curve, float]:
    """A curve slowed until it keeps the limits on every sample, and smoothed to the jerk limit.

    Returns:
        The curve and its duration, a whole multiple of the grid [s].

    Raises:
        TimingError: Stretching does not help.
    """
    slowed, total = slowed_to_limits(curve, duration, limits)
    if not np.isfinite(limits.jerk):
        return slowed, total
    _, _, accelerations = slowed(time_grid(total))
    window = on_grid(float(np.abs(accelerations).max()) / limits.jerk)
    for _ in range(_MOST_STRETCHES):
        mean = smoothed(slowed, total, window)
        jerk = largest_jerk(mean, total + window)
        if jerk <= limits.jerk:
            break
        window = on_grid(max(window * min(jerk / limits.jerk, 2.0), window + GRID))
    else:
        raise TimingError(f"the jerk stays above {limits.jerk:g} however long it is spread")
    return slowed_to_limits(mean, total + window, limits)


def slowed_to_limits(curve: Curve, duration: float, limits: Limits) -> tuple[Curve, float]:
    """A curve run more slowly, until every sample of the time grid keeps the limits.

    Returns:
        The slower curve and its duration, a whole multiple of the grid [s].

    Raises:
        TimingError: Stretching does not help: the curve is not smooth enough.
    """
    total, excess = on_grid(duration), np.inf
    for _ in range(_MOST_STRETCHES):
        slowed = stretched(curve, duration, total)
        positions, velocities, accelerations = slowed(time_grid(total))
        excess = limits.excess(velocities, accelerations)
        some = slice(None, None, EFFORT_PERIOD)
        effort = limits.effort_excess(positions[some], velocities[some], accelerations[some])
        excess = max(excess, effort)
        if excess <= 1.0 + 1e-9:
            return slowed, total
        total = on_grid(max(total * excess, total + GRID))
    raise TimingError(f"the limits are exceeded {excess:.3g} times however slow the motion is")


def sampled_within_limits(
    joint_names: tuple[str, ...], curve: Curve, duration: float, limits: Limits
) -> JointTrajectory:
    """Set points of a curve, run more slowly until commands between them keep the limits as well.

    A controller interpolates set points by cubics. Where the acceleration of the curve jumps
    between two of them, the cubic accelerates up to 1.5 times as much. Such a curve is first
    smoothed over the periods between set points, and then slowed by what remains.
    """
    trajectory = sample(joint_names, curve, duration)
    if _interpolated_excess(trajectory, limits) <= 1.0 + 1e-9:
        return trajectory
    mean = smoothed(curve, duration, SMOOTHED_PERIODS * SAMPLE_PERIOD)
    length = total = duration + SMOOTHED_PERIODS * SAMPLE_PERIOD
    while True:
        trajectory = sample(joint_names, stretched(mean, length, total), total)
        excess = _interpolated_excess(trajectory, limits)
        if excess <= 1.0 + 1e-9:
            return trajectory
        total = on_grid(max(total * np.sqrt(excess), total + GRID))


def _interpolated_excess(trajectory: JointTrajectory, limits: Limits) -> float:
    """How many times the cubics between set points exceed the accelerations of the joints."""
    if limits.commanded is None or len(trajectory.times) < 2:
        return 0.0
    step = np.diff(trajectory.times)[:, None]
    mean = np.diff(trajectory.positions, axis=0) / step
    before, after = trajectory.velocities[:-1], trajectory.velocities[1:]
    first = (6.0 * mean - 4.0 * before - 2.0 * after) / step
    last = (-6.0 * mean + 2.0 * before + 4.0 * after) / step
    return float(np.max(np.maximum(np.abs(first), np.abs(last)) / limits.commanded))


def largest_jerk(curve: Curve, total: float) -> float:
    """Largest jerk of a joint between samples of the time grid, at rest before and after."""
    _, _, accelerations = curve(time_grid(total))
    rest = np.zeros_like(accelerations[:1])
    changes = np.diff(np.concatenate([rest, accelerations[1:-1], rest]), axis=0)
    return float(np.abs(changes).max()) / GRID


def stretched(curve: Curve, duration: float, total: float) -> Curve:
    """A curve run in another time [s]."""
    factor = duration / total

    def slowed(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        positions, velocities, accelerations = curve(np.minimum(times * factor, duration))
        return positions, velocities * factor, accelerations * factor**2

    return slowed


def time_grid(total: float) -> FloatArray:
    """Every sample of the time grid from 0 to a duration on it [s]."""
    grid: FloatArray = np.arange(round(total / GRID) + 1, dtype=np.float64) * GRID
    return grid
