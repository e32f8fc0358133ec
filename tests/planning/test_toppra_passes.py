"""TOPP-RA's passes find what the library toppra finds, and exceed no limit."""

# pyright: reportAttributeAccessIssue=false

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from harness.planning.timing.limits import Limits, TimingError
from harness.planning.timing.timing import BlendedPath
from harness.planning.timing.toppra_passes import half_planes, squared_rates
from harness.planning.timing.toppra_solver import Bounds, fastest, joint_bounds


@cache
def library():
    """The library, which imports matplotlib, and its inputs as classes of a path and of bounds."""
    toppra = pytest.importorskip("toppra", reason="it has no wheel for this platform")

    class Geometry(toppra.interpolator.AbstractGeometricPath):
        dof, path_interval, waypoints = 0, None, None

        def __init__(self, path, dof):
            self.path, self.dof, self.path_interval = path, dof, np.array([0.0, path.length])

        def __call__(self, parameters, order=0):
            return self.path.cubics.evaluate(parameters)[order]

    class Known(toppra.constraint.LinearConstraint):
        """The bounds as the library takes them."""

        def __init__(self, bounds, grid):
            super().__init__()
            self.identical = True
            kinds = len(bounds.most)
            sides = np.vstack([np.eye(kinds), -np.eye(kinds)])
            rows = bounds.speeds, bounds.bends, bounds.offsets, sides, np.tile(bounds.most, 2)
            if bounds.between:
                scheme = toppra.constraint.linear_constraint.canlinear_colloc_to_interpolate
                rows = scheme(*rows, None, None, grid, identical=True)[:5]
            rates = bounds.rate_squared
            limits = None if rates is None else np.column_stack([np.zeros_like(rates), rates])
            self.parameters = (*rows, None, limits)

        def compute_constraint_params(self, *_):
            return self.parameters

    return toppra, Geometry, Known


def drawn(seed):
    rng = np.random.default_rng(seed)
    dof = int(rng.integers(1, 9))
    waypoints = np.cumsum(rng.uniform(-1, 1, (rng.integers(3, 7), dof)), axis=0)
    path = BlendedPath(waypoints, rng.uniform(0.01, 0.1))
    limits = Limits.scaled(rng.uniform(0.3, 3, dof), rng.uniform(0.3, 10, dof), 1.0, 1.0)
    return path, limits, path.grid()


def drawn_bounds(seed):
    """Bounds of joints, on some paths with efforts of a constant load and a collocated bound."""
    path, limits, grid = drawn(seed)
    states = path.cubics.evaluate(grid)
    bounds = [joint_bounds(states, limits)]
    rng = np.random.default_rng([seed, 1])
    if seed % 2:
        efforts = rng.normal(size=(3, len(grid), 2)).cumsum(axis=1) / 10
        most = np.abs(efforts[2]).max(axis=0) + rng.uniform(0.1, 5, 2)
        bounds.append(Bounds(*efforts, most))
    if seed % 3 == 0:
        row = rng.normal(size=(2, len(grid), 1))
        slow = rng.uniform(0.05, 2, len(grid))
        bounds.append(Bounds(*row, 0 * row[0], np.ones(1), slow, between=False))
    return path, bounds, grid


def duration(squares, grid):
    rates = np.sqrt(squares)
    return float((2 * np.diff(grid) / (rates[:-1] + rates[1:])).sum())


def agree(seeds):
    toppra, geometry_of, bounds_of = library()
    for seed in seeds:
        path, bounds, grid = drawn_bounds(seed)
        known = [bounds_of(each, grid) for each in bounds]
        geometry = geometry_of(path, len(path.ends[0]))
        solver = toppra.algorithm.TOPPRA(known, geometry, gridpoints=grid, solver_wrapper="seidel")
        _, reference, _ = solver.compute_parameterization(0, 0)
        found = squared_rates(bounds, grid)
        expected = duration(reference**2, grid)
        assert duration(found, grid) == pytest.approx(expected, rel=1e-6), seed
        now, after, room = half_planes(bounds, grid)
        excess = now * found[:-1, None] + after * found[1:, None] - room
        assert excess.max() <= 1e-8, seed


def test_the_duration_is_the_librarys_and_no_limit_is_exceeded():
    agree(range(40))


@pytest.mark.nightly
@pytest.mark.parametrize("part", range(10))
def test_ten_thousand_paths_last_as_long_as_the_library_makes_them(part):
    agree(range(1000 * part, 1000 * (part + 1)))


@pytest.mark.parametrize("standing", [2.0, -2.0])
def test_where_the_bounds_forbid_to_stand_still_there_are_no_times(standing):
    path, limits, grid = drawn(1)
    none = np.zeros((len(grid), 1))
    forbidding = Bounds(none + 0.01, none, none + standing, np.ones(1))
    assert (
        squared_rates([joint_bounds(path.cubics.evaluate(grid), limits), forbidding], grid) is None
    )


def test_limits_without_times_are_an_error():
    path, limits, grid = drawn(1)
    with pytest.raises(TimingError, match="TOPP-RA found no times"):
        fastest(path.cubics, replace(limits, acceleration=0 * limits.acceleration - 1.0), grid)
