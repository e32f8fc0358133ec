"""Motion along one parameter: trapezoids of velocity and point-to-point cubics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.collision.native.library import call

GRID = 0.002  # Durations are whole multiples of this [s]: two of the physics' default time steps
SAMPLE_PERIOD = 0.01
"""Time between set points [s]: five steps of the grid; the last one may be nearer."""

Curve = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
"""Positions, velocities and accelerations, (N, dof) each, at times (N,)."""


@dataclass(frozen=True)
class Trapezoid:
    """A motion from 0 to `length`, at rest at both ends, under limits of velocity and acceleration.

    Attributes:
        length: The length of the parameter.
        velocity: Reached in the middle part.
        acceleration: The acceleration at both ends.
        duration: A whole multiple of `GRID` [s].
    """

    length: float
    velocity: float
    acceleration: float
    duration: float

    @classmethod
    def fastest(cls, length: float, velocity: float, acceleration: float) -> Trapezoid:
        """The quickest profile under the limits, stretched to the time grid."""
        peak = min(velocity, float(np.sqrt(length * acceleration)))
        duration = length / peak + peak / acceleration
        stretch = on_grid(duration) / duration
        return cls(length, peak / stretch, acceleration / stretch**2, duration * stretch)

    def __call__(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parameter, its rate and its acceleration at times (N,)."""
        ramp = self.velocity / self.acceleration
        t = np.clip(times, 0.0, self.duration)
        left = self.duration - t
        rising, falling = t < ramp, left < ramp
        s = np.where(
            rising,
            0.5 * self.acceleration * t**2,
            np.where(
                falling,
                self.length - 0.5 * self.acceleration * left**2,
                self.velocity * (t - 0.5 * ramp),
            ),
        )
        rate = np.where(
            rising,
            self.acceleration * t,
            np.where(falling, self.acceleration * left, self.velocity),
        )
        change = np.where(rising, self.acceleration, np.where(falling, -self.acceleration, 0.0))
        return s, rate, change


@dataclass(frozen=True, eq=False)
class JerkLimited:
    """A motion from 0 to 1 with piecewise constant jerk, at rest at both ends.

    Attributes:
        duration: A whole multiple of `GRID` [s].
        knots: Times between the pieces, shape (8,), from 0 to `duration` [s].
        states: Parameter, rate and acceleration at each knot, shape (8, 3).
        jerks: Jerk of each piece, shape (7,).
    """

    duration: float
    knots: FloatArray
    states: FloatArray
    jerks: FloatArray

    @classmethod
    def fastest(cls, velocity: float, acceleration: float, jerk: float) -> JerkLimited:
        """The quickest profile under limits of rate, acceleration and jerk, on the time grid.

        The acceleration rises for `ramp`, is constant for `hold` and falls for `ramp`; then the
        rate is constant for `cruise`, and the other half mirrors the first.
        """
        ramp = min(acceleration / jerk, np.sqrt(velocity / jerk), np.cbrt(0.5 / jerk))
        peak = jerk * ramp
        # Without a cruise, ramp + hold is the time t with peak t (t + ramp) = 1.
        hold = min(velocity / peak, 0.5 * (np.sqrt(ramp**2 + 4 / peak) - ramp)) - ramp
        hold = max(0.0, hold)
        rate = peak * (ramp + hold)
        cruise = max(0.0, 1 / rate - 2 * ramp - hold)
        lengths = np.array([ramp, hold, ramp, cruise, ramp, hold, ramp])
        stretch = on_grid(float(lengths.sum())) / float(lengths.sum())
        lengths, jerks = lengths * stretch, np.array([1, 0, -1, 0, -1, 0, 1]) * jerk / stretch**3
        states = [np.zeros(3)]
        for piece, length in zip(jerks, lengths, strict=True):
            states.append(_advanced(states[-1][None], np.array([piece]), np.array([length]))[0])
        knots = np.concatenate([[0.0], np.cumsum(lengths)])
        return cls(float(knots[-1]), knots, np.array(states), jerks)

    def __call__(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parameter, its rate and its acceleration at times (N,)."""
        inside = np.clip(times, 0.0, self.duration)
        piece = np.clip(np.searchsorted(self.knots, inside, side="right") - 1, 0, 6)
        found = _advanced(self.states[piece], self.jerks[piece], inside - self.knots[piece])
        return found[:, 0], found[:, 1], found[:, 2]


def _advanced(states: FloatArray, jerk: FloatArray, time: FloatArray) -> FloatArray:
    """Parameter, rate and acceleration (N, 3) some time (N,) later, under constant jerk (N,)."""
    s, rate, change = states.T
    return np.column_stack(
        [
            s + time * (rate + time * (change / 2 + time * jerk / 6)),
            rate + time * (change + time * jerk / 2),
            change + time * jerk,
        ]
    )


def on_grid(duration: float) -> float:
    """The duration, lengthened to the next multiple of `GRID` [s]."""
    return float(max(1, np.ceil(duration / GRID - 1e-9)) * GRID)


Profile = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
"""A parameter, its rate and its acceleration, (N,) each, at times (N,)."""


def straight_curve(first: FloatArray, second: FloatArray, profile: Profile) -> Curve:
    """Along a straight joint-space line, `profile` running from 0 to 1."""
    span = second - first

    def curve(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        s, rate, change = profile(times)
        return first + s[:, None] * span, rate[:, None] * span, change[:, None] * span

    return curve


def cubic(duration: float) -> Profile:
    """From 0 to 1, at rest on both ends, as a JointTrajectoryController interpolates."""

    def profile(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        u = np.clip(times / duration, 0.0, 1.0)
        return 3 * u**2 - 2 * u**3, (6 * u - 6 * u**2) / duration, (6 - 12 * u) / duration**2

    return profile


def quintic(duration: float) -> Profile:
    """From 0 to 1, rate and acceleration zero on both ends: the least jerk over its time."""

    def profile(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        u = np.clip(times / duration, 0.0, 1.0)
        rate, change = 30 * (u * (1 - u)) ** 2, 60 * u * (1 - u) * (1 - 2 * u)
        return ((6 * u - 15) * u + 10) * u**3, rate / duration, change / duration**2

    return profile


def sample(joint_names: tuple[str, ...], curve: Curve, duration: float) -> JointTrajectory:
    """Set points of a curve every `SAMPLE_PERIOD`, its end included."""
    count = int(np.floor(duration / SAMPLE_PERIOD + 1e-9))
    times: FloatArray = np.arange(count + 1, dtype=np.float64) * SAMPLE_PERIOD
    if duration - times[-1] > 1e-9:
        times = np.concatenate([times, [duration]])
    times[-1] = duration
    positions, velocities, accelerations = curve(times)
    velocities[[0, -1]] = 0.0
    return JointTrajectory(joint_names, times, positions, velocities, accelerations)


def resting(joint_names: tuple[str, ...], positions: FloatArray) -> JointTrajectory:
    """The trajectory of a motion that has nowhere to go: one sample period at rest."""
    still = np.zeros((2, len(positions)))
    return JointTrajectory(
        joint_names, np.array([0.0, SAMPLE_PERIOD]), np.vstack([positions] * 2), still, still.copy()
    )


def smoothed(curve: Curve, duration: float, window: float) -> Curve:
    """The running mean of a curve over a window: no jerk above an acceleration's change over it.

    It begins and ends where the curve does, at rest if the curve does, and lasts `window` longer;
    velocities and accelerations stay within what the curve's keep to.

    References:
        L. Biagiotti, C. Melchiorri, "FIR filters for online trajectory planning with time- and
        frequency-domain specifications", Control Engineering Practice 20(12), 2012.
    """
    count = max(1, int(np.ceil(2 * duration / SAMPLE_PERIOD)))
    knots: FloatArray = np.linspace(0.0, duration, count + 1)
    step = duration / count
    at, rates, _ = curve(knots)
    rates[[0, -1]] = 0.0
    pieces = 0.5 * step * (at[:-1] + at[1:]) + step**2 / 12 * (rates[:-1] - rates[1:])
    sums = np.concatenate([np.zeros_like(at[:1]), np.cumsum(pieces, axis=0)])

    def mean(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        both = np.concatenate([times, times - window])
        states = curve(np.clip(both, 0.0, duration))[:2]
        means = np.empty((3, len(times), at.shape[1]))
        given = both, knots, sums, at, rates, *states, np.array([step, window])
        positions, velocities, accelerations = call("window_means", given, means)
        return positions, velocities, accelerations

    return mean
