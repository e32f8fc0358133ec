"""Explains the first two planning stages: whether the arm reaches the goal, and its branches."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.checker import touch_records
from harness.planning.collision.wording import counted_noun, joint_value, touches
from harness.planning.diagnosis.branch_stage import branches_finding
from harness.planning.diagnosis.reach_stage import reach_finding
from harness.planning.diagnosis.stage_request import StageFinding, StageRequest
from harness.planning.goals.goal_study import GoalStudy, broken_limits, limit_sentence, study_goal
from harness.planning.ik.numeric import LinkGoal
from harness.ports import JointGoal
from harness.recording.explanation import NearestState, Stage


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
    advice = (
        f"choose other joint positions, or move {found[0].second} out of the way; with a `pose` "
        "the planner chooses among all branches"
    )
    return [reach, StageFinding(stage, nearest, advice)]
