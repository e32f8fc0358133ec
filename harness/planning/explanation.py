"""Says of a motion that was not found what became of each stage of planning it, in order."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.checker import MotionChecker
from harness.planning.goal_stages import goal_findings, target_positions
from harness.planning.kinematics import PinocchioKinematics
from harness.planning.motion_stages import path_finding, start_finding, timing_finding
from harness.planning.robot_model import GroupSpace
from harness.planning.scene import CoalScene
from harness.planning.stage_request import Finding, StageRequest
from harness.ports import Goal, JointGoal, PlanningOptions, PoseGoal, PositionGoal

_NO_STAGE = ("INVALID_GROUP_NAME", "INVALID_LINK_NAME", "UNRECOGNIZED_GOAL_TYPE")

_P = ParamSpec("_P")
_R = TypeVar("_R")


class _Planner(Protocol):
    scene: CoalScene
    kinematics: PinocchioKinematics


_S = TypeVar("_S", bound=_Planner)


def explained(
    method: Callable[Concatenate[_S, _P], _R],
) -> Callable[Concatenate[_S, _P], _R]:
    """Let a planner's method explain its failures: `stages`, `nearest`, `advice` in the facts.

    The method takes `group`, `start`, then a goal (a Goal, or joint positions) where it has one,
    and PlanningOptions somewhere behind.
    """

    @wraps(method)
    def explaining(self: _S, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            return method(self, *args, **kwargs)
        except PlanningFailed as failure:
            if failure.code not in _NO_STAGE and "stages" not in failure.facts:
                request = _request(failure, self, [*args, *kwargs.values()])
                failure.facts.update(explanation_of(request))
            raise

    return explaining


def explanation_of(request: StageRequest) -> dict[str, Any]:
    """Of a failed call as plain data.

    `stages` in the order of `recording.explanation.STAGES`; of the first that failed `nearest`, a
    state of the robot to draw, and `advice`, what to do. A start that no motion can leave comes
    before the goal: no other goal helps.
    """
    findings: list[Finding] = goal_findings(request)
    start = start_finding(request)
    findings += [start, path_finding(request, target_positions(request))]
    findings.append(timing_finding(request))
    facts: dict[str, Any] = {"stages": [finding.stage.plain() for finding in findings]}
    if request.failure.code.startswith("START_STATE"):
        findings.insert(0, start)
    nearest = next((finding.nearest for finding in findings if finding.nearest), None)
    if nearest is not None:
        facts["nearest"] = dict(nearest)
    advice = next((finding.advice for finding in findings if finding.advice), "")
    if advice:
        facts["advice"] = advice
    return facts


def _request(failure: PlanningFailed, planner: _Planner, asked: list[Any]) -> StageRequest:
    """What was asked in a call `(group, start, goal, ...)`, and what checks its states."""
    start = np.asarray(asked[1], dtype=float)
    options = next((item for item in asked if isinstance(item, PlanningOptions)), PlanningOptions())
    space = GroupSpace(planner.kinematics.robot, str(asked[0]), start)
    return StageRequest(
        failure=failure,
        kinematics=planner.kinematics,
        scene=planner.scene,
        space=space,
        start=start,
        goal=_goal(asked[2]),
        options=options,
        checker=_checker(planner.scene, space, start, options),
    )


def _goal(asked: Any) -> Goal | None:
    if isinstance(asked, JointGoal | PoseGoal | PositionGoal):
        return asked
    return JointGoal(asked) if isinstance(asked, np.ndarray) else None


def _checker(
    scene: CoalScene, space: GroupSpace, start: FloatArray, options: PlanningOptions
) -> MotionChecker | None:
    """None where no motion can begin."""
    try:
        return MotionChecker(scene, space, space.part(start), options.padding)
    except PlanningFailed:
        return None
