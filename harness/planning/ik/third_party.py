"""Runs a third-party inverse kinematics solver: its errors and unusable answers are named."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.core.errors import PlanningFailed
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
    if not isinstance(found, IkResult):  # pyright: ignore[reportUnnecessaryIsInstance]
        what = f"returned {type(found).__name__}, not an IkResult"
        raise PlanningFailed("CRASH", f"{who} {what}", *details)
    solutions = [_positions(each) for each in found.solutions]
    for each in solutions:
        if each is None or each.shape != (request.space.dof,) or not np.all(np.isfinite(each)):
            what = f"returned a solution that is not {request.space.dof} finite joint positions"
            raise PlanningFailed("CRASH", f"{who} {what}", *details)
    return IkResult(tuple(each for each in solutions if each is not None), float(found.excess))


def _positions(solution: Any) -> FloatArray | None:
    try:
        return np.array(solution, dtype=float)
    except (TypeError, ValueError):
        return None
