"""TOPP-RA's two passes over the linear programs of the library `toppra`.

The library is imported without the pictures, splines and sparse solvers that are not used here. Its
own passes look for other solvers in the file system, format all limits as text and solve a program
for each lower bound, which is zero wherever the robot can stand still: 4.4 times the time.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import logging
import warnings
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from harness.core.deferred_import import deferred
from harness.core.types import FloatArray
from harness.planning.timing.toppra_solver import Bounds

with (
    warnings.catch_warnings(),
    deferred("matplotlib", "matplotlib.pyplot", "scipy", "scipy.sparse", "scipy.interpolate"),
):
    warnings.simplefilter("ignore")  # invalid escapes of its own
    from toppra.constraint import LinearConstraint
    from toppra.constraint.linear_constraint import canlinear_colloc_to_interpolate
    from toppra.solverwrapper import seidelWrapper
logging.getLogger("toppra").setLevel(logging.CRITICAL)

TIES = 1e-9
"""Weight of the parameter's acceleration next to the square of its rate, as in the library."""

ROUNDING, LEAST_ROUNDING = 1e-4, 1e-8
"""How much slower each step of the second pass is than its program's solution, as a share and at
least [1/s^2], so that rounding does not make the next program infeasible; as in the library."""

MOST_TRIES = 10
"""How often a rate is lowered whose program is infeasible by rounding, as in the library."""


class _Given(LinearConstraint):
    """Constraints whose coefficients are known at each grid point."""

    def __init__(self, bounds: Bounds, grid: FloatArray) -> None:
        super().__init__()
        self.identical = True
        kinds = len(bounds.most)
        sides = np.vstack([np.eye(kinds), -np.eye(kinds)])
        rows = bounds.speeds, bounds.bends, bounds.offsets, sides, np.tile(bounds.most, 2)
        if bounds.between:
            rows = canlinear_colloc_to_interpolate(*rows, None, None, grid, identical=True)[:5]
        rates = bounds.rate_squared
        limits = None if rates is None else np.column_stack([np.zeros_like(rates), rates])
        self._parameters = (*rows, None, limits)

    def compute_constraint_params(self, path: Any, gridpoints: FloatArray) -> tuple[Any, ...]:
        del path, gridpoints
        return self._parameters


def squared_rates(bounds: Sequence[Bounds], grid: FloatArray) -> FloatArray | None:
    """The largest squares of the parameter's rate at grid points (N + 1,), at rest at both ends.

    Args:
        bounds: Bounds under which standing still is possible at every grid point.
        grid: The parameter, ascending, shape (N + 1,).

    Returns:
        None where there is no solution.
    """
    given = [_Given(each, grid) for each in bounds]
    interval = SimpleNamespace(path_interval=grid[[0, -1]])
    solver = seidelWrapper(given, interval, grid, solve_lp1d=True)
    most = _controllable(solver, len(grid))
    return None if most is None else _reached(solver, 2 * np.diff(grid), most)


def _controllable(solver: seidelWrapper, count: int) -> FloatArray | None:
    """The first pass: the largest squared rates from which rest at the end can be reached."""
    most, direction, free = np.zeros(count), np.array([TIES, -1.0]), float("nan")
    for row in range(count - 2, -1, -1):
        after = most[row + 1]
        most[row] = solver.solve_stagewise_optim(row, None, direction, free, free, 0.0, after)[1]
        if not most[row] >= 0:
            return None
    return most


def _reached(solver: seidelWrapper, steps: FloatArray, most: FloatArray) -> FloatArray | None:
    """The second pass: the largest squared rates from rest at the start, below those."""
    found = np.zeros(len(most))
    row = tries = 0
    while row < len(steps):
        direction, here, after = np.array([-steps[row], -1.0]), found[row], most[row + 1]
        change = solver.solve_stagewise_optim(row, None, direction, here, here, 0.0, after)[0]
        if np.isnan(change):
            tries += 1
            if tries > MOST_TRIES:
                return None
            found[row] = max(here - LEAST_ROUNDING, 0.999 * here)
            continue
        there = here + steps[row] * change
        there = max(there - LEAST_ROUNDING, (1 - ROUNDING) * there)
        row, tries = row + 1, 0
        found[row] = min(after, max(0.0, there))
    return found
