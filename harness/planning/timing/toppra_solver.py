"""Computes the fastest times along a joint-space curve under limits, with TOPP-RA."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from harness.core.types import FloatArray
from harness.planning.timing.limits import Limits, TimingError
from harness.planning.timing.profiles import SAMPLE_PERIOD, Curve

UNLIMITED_EFFORT = 1e6
"""Stands for no limit [N m or N]: the solver takes finite numbers."""


class JointCurve(Protocol):
    """A curve in joint space over a parameter from 0 to its length."""

    length: float

    def evaluate(self, parameter: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions and their first two derivatives, (M, dof) each, at parameters (M,)."""
        ...


@dataclass(frozen=True, eq=False)
class LinkLimits:
    """What a link may do along a curve, at every grid point; shape (M,) each.

    With the parameter's rate squared x and its acceleration u: `rate_squared` bounds x, and
    |speeds u + bends x| <= 1 bounds accelerations, one column a kind, shape (M, k).
    """

    rate_squared: FloatArray
    speeds: FloatArray
    bends: FloatArray


def fastest(
    path: JointCurve, limits: Limits, grid: FloatArray, link_limits: LinkLimits | None = None
) -> tuple[Curve, float]:
    """TOPP-RA's solution as a curve over time, and its duration [s].

    Effort limits take part only where the solution without them breaks them: where it does not,
    it is the solution with them too.

    Raises:
        TimingError: There is no solution.

    References:
        H. Pham, Q.-C. Pham, "A New Approach to Time-Optimal Path Parameterization Based on
        Reachability Analysis", IEEE T-RO 34(3), 2018.
    """
    constraints = _joint_constraints(limits)
    if link_limits is not None:
        constraints.append(_link_constraint(link_limits, len(limits.velocity)))
    timed, duration = _solve(path, constraints, grid, len(limits.velocity))
    times: FloatArray = np.arange(0.0, duration, SAMPLE_PERIOD)
    if limits.effort_excess(*timed(times)) > 1.0:
        constraints.append(_effort_constraint(limits))
        timed, duration = _solve(path, constraints, grid, len(limits.velocity))
    return timed, duration


def _joint_constraints(limits: Limits) -> list[Any]:
    ta = _toppra()
    return [
        ta.constraint.JointVelocityConstraint(np.column_stack([-limits.velocity, limits.velocity])),
        ta.constraint.JointAccelerationConstraint(
            np.column_stack([-limits.acceleration, limits.acceleration])
        ),
    ]


def _effort_constraint(limits: Limits) -> Any:
    dynamics = limits.dynamics
    if dynamics is None:
        raise TimingError("the robot has no effort limits")
    most = np.minimum(dynamics.limits, UNLIMITED_EFFORT)
    bounds = np.column_stack([-most, most])

    def inverse_dynamics(q: FloatArray, qd: FloatArray, qdd: FloatArray) -> FloatArray:
        return dynamics.efforts(q[None], qd[None], qdd[None])[0]

    constraint = _toppra().constraint
    return constraint.JointTorqueConstraint(
        inverse_dynamics,
        bounds,
        np.zeros(len(bounds)),
        constraint.DiscretizationType.Interpolation,
    )


def _link_constraint(limits: LinkLimits, dof: int) -> Any:
    constraint = _toppra().constraint
    kinds = limits.speeds.shape[1]

    class OnLink(constraint.LinearConstraint):
        def __init__(self) -> None:
            super().__init__()
            self.dof = dof
            self.identical = True
            self.set_discretization_type(constraint.DiscretizationType.Collocation)

        def compute_constraint_params(self, path: Any, gridpoints: FloatArray) -> tuple[Any, ...]:
            del path
            sides = np.vstack([np.eye(kinds), -np.eye(kinds)])
            x_bound = np.column_stack([np.zeros(len(gridpoints)), limits.rate_squared])
            none = np.zeros_like(limits.speeds)
            return limits.speeds, limits.bends, none, sides, np.ones(2 * kinds), None, x_bound

    return OnLink()


def _solve(
    path: JointCurve, constraints: list[Any], grid: FloatArray, dof: int
) -> tuple[Curve, float]:
    ta = _toppra()

    class Geometry(ta.interpolator.AbstractGeometricPath):
        def __call__(self, path_positions: Any, order: int = 0) -> FloatArray:
            values = path.evaluate(path_positions)[order]
            return values[0] if np.ndim(path_positions) == 0 else values

        @property
        def dof(self) -> int:
            return dof

        @property
        def path_interval(self) -> FloatArray:
            return np.array([0.0, path.length])

        @property
        def waypoints(self) -> None:
            return None

    solver = ta.algorithm.TOPPRA(constraints, Geometry(), gridpoints=grid)
    _, rates, _ = solver.compute_parameterization(0, 0)
    if rates is None or not np.isfinite(rates).all():
        raise TimingError("TOPP-RA found no times under the limits")
    return _timed(path, grid, rates)


def _timed(path: JointCurve, grid: FloatArray, rates: FloatArray) -> tuple[Curve, float]:
    """The path with constant acceleration of its parameter between grid points, and its duration.

    Args:
        path: The curve that gets its times.
        grid: The parameter at each grid point, shape (N + 1,).
        rates: Its rate at each grid point [1/s], shape (N + 1,).
    """
    steps = np.diff(grid)
    growths = 0.5 * np.diff(rates**2) / steps
    ends = np.concatenate([[0.0], np.cumsum(2 * steps / (rates[:-1] + rates[1:]))])

    def timed(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        step = np.minimum(np.searchsorted(ends, times, side="right") - 1, len(steps) - 1)
        since, growth = times - ends[step], growths[step]
        parameter = grid[step] + since * rates[step] + 0.5 * since**2 * growth
        rate = (rates[step] + since * growth)[:, None]
        positions, first, second = path.evaluate(parameter)
        return positions, first * rate, second * rate**2 + first * growth[:, None]

    return timed, float(ends[-1])


def _toppra() -> Any:
    from harness.planning.timing.toppra_library import toppra  # here: not every motion needs it

    return toppra
