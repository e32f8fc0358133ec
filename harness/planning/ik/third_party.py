"""Runs a third-party inverse kinematics solver: its errors and unusable answers are named."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.core.errors import HarnessError, PlanningFailed
from harness.core.registry import described, raised
from harness.core.types import FloatArray
from harness.ports.kinematics import IkRequest, IkResult, IkSolver
from harness.recording.explanation import Explanation
from harness.recording.goal_failures import SolverFailure


def solve_with_third_party(solver: type[IkSolver], request: IkRequest) -> IkResult:
    """Solve with a plug-in's class.

    Raises:
        PlanningFailed: CRASH, when it raises an exception, or returns what are no joint positions.
    """
    who = described("ik_solver", solver.name)
    advice = f"correct the plug-in `{solver.name}`, or give the robot another `ik_solver`"
    details = SolverFailure(solver.name), Explanation(advice=advice)
    try:
        found = solver().solve(request)
    except Exception as error:
        raise PlanningFailed("CRASH", f"{who} raised {raised(error)}", *details) from error
    try:
        solutions = read_solutions(found, request.space.dof)
    except UnusableIkResult as error:
        raise PlanningFailed("CRASH", f"{who} {error}", *details) from error
    if not all(np.all(np.isfinite(each)) for each in solutions):
        what = f"returned a solution that is not {request.space.dof} finite joint positions"
        raise PlanningFailed("CRASH", f"{who} {what}", *details)
    return IkResult(solutions, float(found.excess))


class UnusableIkResult(HarnessError):
    """A solver returned something else than joint positions in an IkResult."""


def read_solutions(found: Any, dof: int) -> tuple[FloatArray, ...]:
    """The solutions of what a solver returned, shape (dof,) each; they may hold NaN.

    Raises:
        UnusableIkResult: These are no joint positions in an IkResult.
    """
    if not isinstance(found, IkResult):
        raise UnusableIkResult(f"returned {type(found).__name__}, not an IkResult")
    try:
        solutions = tuple(np.array(each, dtype=float) for each in found.solutions)
    except (TypeError, ValueError):
        solutions = (np.empty(0),)
    if any(each.shape != (dof,) for each in solutions):
        what = f"returned a solution that is not {dof} joint positions"
        raise UnusableIkResult(f"{what}: `solutions` is a sequence of vectors")
    return solutions
