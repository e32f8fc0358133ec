"""Runs a third-party planning pipeline: its budget ends, its errors and wrong answers are named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, ParamSpec

import numpy as np

from harness.core.amounts import amount
from harness.core.errors import PlanningFailed
from harness.core.registry import described, raised
from harness.core.types import FloatArray
from harness.ports.path_planning import PathPlanner, PathRequest, PathResult
from harness.recording.explanation import Explanation
from harness.recording.motion_failures import PipelineFailure

END_DISTANCE = 1e-6  # How far a path may begin from the start, and end from a goal [rad or m]
P = ParamSpec("P")


class BudgetUsedUpError(Exception):
    """Ends a search whose state checks are used up."""


def find_third_party_path(planner: type[PathPlanner], request: PathRequest) -> PathResult:
    """Search with a plug-in's class.

    Raises:
        PlanningFailed: CRASH, when it raises an exception; INVALID_MOTION_PLAN, when its answer is
            not a path from the start to a goal.
    """
    who = described("planner", planner.name)
    plugin = PipelineFailure(planner.name)
    try:
        found = planner().find_path(_limited(request))
    except BudgetUsedUpError:
        return PathResult(None)
    except Exception as error:
        advice = Explanation(advice=plugin.advice)
        raise PlanningFailed("CRASH", f"{who} raised {raised(error)}", plugin, advice) from error
    wrong, waypoints = _waypoints(found, request)
    if wrong:
        raise PlanningFailed("INVALID_MOTION_PLAN", f"{who} {wrong}", plugin)
    return replace(found, waypoints=waypoints)


def _limited(request: PathRequest) -> PathRequest:
    """The request with arrays that cannot be changed, and checks that end with the budget."""

    def limited(check: Callable[P, bool]) -> Callable[P, bool]:
        def limited_check(*args: P.args, **kwargs: P.kwargs) -> bool:
            if request.state_checks() >= request.max_state_checks:
                raise BudgetUsedUpError
            return check(*args, **kwargs)

        return limited_check

    return replace(
        request,
        start=_read_only(request.start),
        goals=tuple(_read_only(goal) for goal in request.goals),
        is_state_free=limited(request.is_state_free),
        is_edge_free=limited(request.is_edge_free),
    )


def _read_only(positions: FloatArray) -> FloatArray:
    copy = np.array(positions, dtype=float)
    copy.flags.writeable = False
    return copy


def _waypoints(found: Any, request: PathRequest) -> tuple[str, FloatArray | None]:
    """What is wrong with an answer, or empty; and its waypoints, with exactly the right ends."""
    if not isinstance(found, PathResult):
        return f"returned {type(found).__name__}, not a PathResult", None
    if found.waypoints is None:
        return "", None
    dof = request.space.dof
    try:
        waypoints = np.array(found.waypoints, dtype=float)
    except (TypeError, ValueError):
        return "returned waypoints that are not numbers", None
    if waypoints.ndim != 2 or waypoints.shape[1] != dof or len(waypoints) < 2:
        shape = ", ".join(map(str, waypoints.shape))
        return f"returned waypoints of shape ({shape}), not (N, {dof}) with N of at least 2", None
    if not np.all(np.isfinite(waypoints)):
        return "returned waypoints that are not finite", None
    away = waypoints[0] - request.start
    if np.max(np.abs(away)) > END_DISTANCE:
        return f"returned a path that begins away from the start: {_farthest(away, request)}", None
    gaps = [waypoints[-1] - goal for goal in request.goals]
    nearest = int(np.argmin([np.max(np.abs(gap)) for gap in gaps]))
    if np.max(np.abs(gaps[nearest])) > END_DISTANCE:
        farthest = _farthest(gaps[nearest], request)
        return f"returned a path that ends away from a goal: {farthest}", None
    waypoints[0] = request.start
    waypoints[-1] = request.goals[nearest]
    return "", waypoints


def _farthest(away: FloatArray, request: PathRequest) -> str:
    """The joint that is farthest off: `elbow by 4.0 deg`."""
    joint = int(np.argmax(np.abs(away)))
    unit = "rad" if request.space.wraps[joint] else "m"
    return f"{request.space.joint_names[joint]} by {amount(abs(float(away[joint])), unit)}"
