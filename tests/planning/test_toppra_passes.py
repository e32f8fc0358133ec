"""The passes over toppra's programs find what the library's own algorithm finds."""

# pyright: reportAttributeAccessIssue=false

import numpy as np
import pytest
import toppra

from harness.planning.timing.limits import Limits, TimingError
from harness.planning.timing.timing import BlendedPath
from harness.planning.timing.toppra_library import squared_rates
from harness.planning.timing.toppra_solver import Bounds, fastest, joint_bounds


class Geometry(toppra.interpolator.AbstractGeometricPath):
    dof, path_interval, waypoints = 0, None, None

    def __init__(self, path, dof):
        self.path, self.dof, self.path_interval = path, dof, np.array([0.0, path.length])

    def __call__(self, parameters, order=0):
        return self.path.evaluate(parameters)[order]


def drawn(seed):
    rng = np.random.default_rng(seed)
    dof = int(rng.integers(1, 9))
    waypoints = np.cumsum(rng.uniform(-1, 1, (rng.integers(3, 7), dof)), axis=0)
    path = BlendedPath(waypoints, rng.uniform(0.01, 0.1))
    limits = Limits.scaled(rng.uniform(0.3, 3, dof), rng.uniform(0.3, 10, dof), 1.0, 1.0)
    return path, limits, path.grid()


@pytest.mark.parametrize("seed", range(20))
def test_the_rates_are_those_of_the_library(seed):
    path, limits, grid = drawn(seed)
    found = squared_rates([joint_bounds(path.evaluate(grid), limits)], grid)
    both = [np.column_stack([-most, most]) for most in (limits.velocity, limits.acceleration)]
    constraint = toppra.constraint
    constraints = [
        constraint.JointVelocityConstraint(both[0]),
        constraint.JointAccelerationConstraint(both[1]),
    ]
    geometry = Geometry(path, len(limits.velocity))
    solver = toppra.algorithm.TOPPRA(constraints, geometry, gridpoints=grid)
    _, rates, _ = solver.compute_parameterization(0, 0)
    assert np.sqrt(found) == pytest.approx(rates, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("standing", [2.0, -2.0])
def test_where_the_bounds_forbid_to_stand_still_there_are_no_times(standing):
    path, limits, grid = drawn(1)
    none = np.zeros((len(grid), 1))
    forbidding = Bounds(none + 0.01, none, none + standing, np.ones(1))
    assert squared_rates([joint_bounds(path.evaluate(grid), limits), forbidding], grid) is None


def test_limits_without_times_are_an_error():
    path, limits, grid = drawn(1)
    with pytest.raises(TimingError, match="TOPP-RA found no times"):
        fastest(path, Limits(limits.velocity, 0 * limits.acceleration - 1.0), grid)
