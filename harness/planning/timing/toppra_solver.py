"""Computes the fastest times along a joint-space curve under limits, with TOPP-RA."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.types import FloatArray
from harness.planning.timing.cubic_spline import PiecewiseCubic
from harness.planning.timing.limits import Limits, TimingError
from harness.planning.timing.profiles import Curve
from harness.planning.timing.toppra_passes import Bounds, squared_rates


def fastest(
    path: PiecewiseCubic, limits: Limits, grid: FloatArray, link_bounds: Bounds | None = None
) -> tuple[Curve, float]:
    """The fastest motion along a path that keeps the limits at the grid points; its duration [s].

    Effort limits take part only where the solution without them breaks them.

    Raises:
        TimingError: There is no solution.
    """
    states = path.evaluate(grid)
    bounds = [each for each in (joint_bounds(states, limits), link_bounds) if each is not None]
    rates = _rates(bounds, grid)
    (positions, first, second), steps = states, np.diff(grid)
    growths = np.append(0.5 * np.diff(rates**2) / steps, 0.0)[:, None]
    velocities, squares = first * rates[:, None], (rates**2)[:, None]
    if limits.effort_excess(positions, velocities, second * squares + first * growths) > 1.0:
        rates = _rates([*bounds, _effort_bounds(states, limits)], grid)
    growths = 0.5 * np.diff(rates**2) / steps
    ends = np.concatenate([[0.0], np.cumsum(2 * steps / (rates[:-1] + rates[1:]))])
    return lambda times: path.timed(times, (ends, grid, rates, growths)), float(ends[-1])


def joint_bounds(states: tuple[FloatArray, FloatArray, FloatArray], limits: Limits) -> Bounds:
    """Bounds of the joints' velocities and accelerations, at the states of a path's grid points."""
    _, first, second = states
    with np.errstate(divide="ignore"):
        rate = np.min(limits.velocity / np.abs(first), axis=1)
    return Bounds(first, second, np.zeros_like(first), limits.acceleration, rate**2)


def _effort_bounds(states: tuple[FloatArray, FloatArray, FloatArray], limits: Limits) -> Bounds:
    dynamics = limits.dynamics
    assert dynamics is not None
    positions, first, second = states
    still = np.zeros_like(positions)
    standing = dynamics.efforts(positions, still, still)
    speeds = dynamics.efforts(positions, still, first) - standing
    bends = dynamics.efforts(positions, first, second) - standing
    most = np.minimum(dynamics.limits, 1e6)  # [N m or N] the solver takes finite numbers
    return Bounds(speeds, bends, standing, most)


def _rates(bounds: Sequence[Bounds], grid: FloatArray) -> FloatArray:
    squares = squared_rates(bounds, grid)
    if squares is None:
        raise TimingError("TOPP-RA found no times under the limits")
    return np.sqrt(squares)
