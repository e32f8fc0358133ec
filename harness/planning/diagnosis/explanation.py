"""Explains a failed planning call: the result of each planning stage, in order."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Protocol, TypeVar

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker, touch_records
from harness.planning.collision.scene import CoalScene
from harness.planning.collision.wording import counted_noun, joint_value, touches
from harness.planning.diagnosis.branch_stage import branches_finding
from harness.planning.diagnosis.motion_stages import path_finding, start_finding, timing_finding
from harness.planning.diagnosis.reach_stage import reach_finding
from harness.planning.diagnosis.stage_request import StageFinding, StageRequest
from harness.planning.goals.goal_study import GoalStudy, broken_limits, limit_sentence, study_goal
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.numeric import LinkGoal
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import AnyGoal, JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.recording.explanation import Explanation, NearestState, Stage

_NO_STAGE = ("INVALID_GROUP_NAME", "INVALID_LINK_NAME", "UNRECOGNIZED_GOAL_TYPE", "CRASH")

_R = TypeVar("_R")


def goal_findings(request: StageRequest) -> list[StageFinding]:
    """Explain reach and inverse kinematics; empty where the motion has no goal of its own."""
    goal = request.goal
    if goal is None:
        return []
    if isinstance(goal, JointGoal):
        return _joint_findings(request, np.asarray(goal.positions, dtype=float))
    study = _study(request, goal)
    return [reach_finding(request, goal, study), branches_finding(request, goal, study)]


def target_positions(request: StageRequest) -> FloatArray | None:
    """Group positions of the first free solution; None where none is free."""
    goal = request.goal
    if goal is None:
        return None
    if isinstance(goal, JointGoal):
        return np.asarray(goal.positions, dtype=float)
    branches = _study(request, goal).branches
    return next((branch.positions for branch in branches if not branch.touches), None)


def _study(request: StageRequest, goal: LinkGoal) -> GoalStudy:
    seed = request.options.seed
    return study_goal(request.kinematics, request.space, request.touches, request.start, goal, seed)


def _joint_findings(request: StageRequest, positions: FloatArray) -> list[StageFinding]:
    space = request.space
    broken = broken_limits(space, positions)
    given = "not needed: the goal gives joint positions"
    if broken:
        first = broken[0]
        below = first.value < first.lower
        limit = joint_value(space, first.joint, first.lower if below else first.upper)
        stage = Stage(
            "reach",
            "failed",
            f"{counted_noun(broken, 'joint')} beyond a limit",
            "GOAL_STATE_INVALID",
            tuple(limit_sentence(space, each) for each in broken),
        )
        nearest = NearestState(
            "nearest joint positions inside the limits",
            request.joints(np.clip(positions, space.lower, space.upper)),
        )
        advice = f"give {first.joint} at {'least' if below else 'most'} {limit}"
        unknown = Stage("inverse kinematics", "skipped", given)
        return [StageFinding(stage, nearest, advice), StageFinding(unknown)]
    reach = StageFinding(Stage("reach", "passed", "every joint is inside its limits"))
    found = request.touches(positions)
    if not found:
        return [
            reach,
            StageFinding(Stage("inverse kinematics", "passed", f"{given}, and they are free")),
        ]
    stage = Stage(
        "inverse kinematics",
        "failed",
        f"{given}; there {touches(found)}",
        "GOAL_IN_COLLISION",
    )
    nearest = NearestState(
        "goal in collision", request.joints(positions), touches=touch_records(found)
    )
    advice = f"choose other joint positions, or move {found[0].second} out of the way"
    return [reach, StageFinding(stage, nearest, advice)]


class _Planner(Protocol):
    scene: CoalScene
    kinematics: PinocchioKinematics


_S = TypeVar("_S", bound=_Planner)


def explained(
    method: Callable[[_S, MotionRequest], _R],
) -> Callable[[_S, MotionRequest], _R]:
    """Add an Explanation to the details of a planner method's failures."""

    @wraps(method)
    def explaining(self: _S, request: MotionRequest) -> _R:
        try:
            return method(self, request)
        except PlanningFailed as failure:
            has_stage = failure.code not in _NO_STAGE and request.options.is_explained
            if has_stage and failure.details.find(Explanation) is None:
                failure.details += Details.of(explanation_of(_request(failure, self, request)))
            raise

    return explaining


def explanation_of(request: StageRequest) -> Explanation:
    """Explain a failed call.

    `stages` follow the order of `recording.explanation.STAGES`. `nearest` is a robot state to draw
    and `advice` is what to do; both belong to the first stage that has them. A start that no
    motion can leave comes before the goal: no other goal helps.
    """
    findings: list[StageFinding] = goal_findings(request)
    start = start_finding(request)
    findings += [start, path_finding(request, target_positions(request))]
    findings.append(timing_finding(request))
    stages = tuple(finding.stage for finding in findings)
    if request.failure.code.startswith("START_STATE"):
        findings.insert(0, start)
    nearest = next((finding.nearest for finding in findings if finding.nearest), None)
    advice = next((finding.advice for finding in findings if finding.advice), None)
    return Explanation(stages, nearest, advice)


def _request(failure: PlanningFailed, planner: _Planner, request: MotionRequest) -> StageRequest:
    """The stages' input. A choice of several goals is explained by what it raised."""
    start = np.asarray(request.start, dtype=float)
    space = GroupSpace(planner.kinematics.robot, request.group, start)
    return StageRequest(
        failure=failure,
        kinematics=planner.kinematics,
        scene=planner.scene,
        space=space,
        start=start,
        goal=None if isinstance(request.goal, AnyGoal) else request.goal,
        options=request.options,
        checker=_checker(planner.scene, space, start, request.options),
    )


def _checker(
    scene: CoalScene, space: GroupSpace, start: FloatArray, options: PlanningOptions
) -> MotionChecker | None:
    """The checker of the motion; None where no motion can begin from the start state."""
    try:
        return MotionChecker(scene, space, space.part(start), options.padding)
    except PlanningFailed:
        return None
