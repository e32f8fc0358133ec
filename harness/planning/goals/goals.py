"""Converts a goal to joint positions that reach it, and explains every candidate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.registry import described
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker, touch_records
from harness.planning.collision.wording import (
    angle,
    counted_noun,
    joint_value,
    length_text,
    point,
    touches,
)
from harness.planning.goals.goal_study import GoalStudy, broken_limits, limit_sentence, study_goal
from harness.planning.ik.answer import LimitedSolution
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.nearest_pose import NearestPose, nearest_pose, target_of
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import Goal, JointGoal, PoseGoal, PositionGoal
from harness.ports.kinematics import IkSolver
from harness.ports.scene import Touch
from harness.recording.goal_failures import CollisionFailure, IkFailure, LimitFailure

_REACHED = 1e-6  # [m, rad] the point is reached within this distance


@dataclass(frozen=True, eq=False)
class GoalCandidates:
    """Free joint positions that reach a goal, nearest first, with the explanation."""

    positions: tuple[FloatArray, ...]
    explanation: Details


def find_goals(
    kinematics: PinocchioKinematics,
    checker: MotionChecker,
    start: FloatArray,
    goal: Goal,
    seed: int,
) -> GoalCandidates:
    """Find free joint positions that reach a goal.

    Raises:
        PlanningFailed: GOAL_STATE_INVALID (joints outside their limits), NO_IK_SOLUTION,
            GOAL_CONSTRAINTS_VIOLATED (the arm's joints are too few for the orientation),
            GOAL_IN_COLLISION, INVALID_LINK_NAME; each with its numbers.
    """
    if isinstance(goal, JointGoal):
        return _joint_goal(checker, goal)

    def find_touches(positions: FloatArray) -> Sequence[Touch]:
        return [] if checker.state_free(positions) else checker.touches(positions)

    study = study_goal(kinematics, checker.space, find_touches, start, goal, seed)
    if not study.answer.solutions:
        raise _no_solution(checker.space, study, start, goal)
    free = tuple(branch.positions for branch in study.branches if not branch.touches)
    if not free:
        ways = counted_noun(study.branches, "way")
        nearest = study.branches[0].touches
        each = "that one" if len(study.branches) == 1 else "each of them"
        raise PlanningFailed(
            "GOAL_IN_COLLISION",
            f"{goal.link} reaches {point(target_of(goal))} in world in {ways},"
            f" {each} in collision; the nearest: {touches(nearest)}",
            study.record,
        )
    return GoalCandidates(free, Details.of(study.record))


def _joint_goal(checker: MotionChecker, goal: JointGoal) -> GoalCandidates:
    space = checker.space
    positions = np.asarray(goal.positions, dtype=float)
    broken = broken_limits(space, positions)
    if broken:
        more = len(broken) - 1
        raise PlanningFailed(
            "GOAL_STATE_INVALID",
            limit_sentence(space, broken[0])
            + (f"; {counted_noun(more, 'more joint')} outside limits" if more else ""),
            LimitFailure(broken),
        )
    positions = np.clip(positions, space.lower, space.upper)
    if not checker.state_free(positions):
        found = checker.touches(positions)
        raise PlanningFailed(
            "GOAL_IN_COLLISION",
            f"at the goal's joint positions these are in collision: {touches(found)}",
            CollisionFailure(touch_records(found)),
        )
    return GoalCandidates((positions,), Details())


def _no_solution(
    space: GroupSpace, study: GoalStudy, start: FloatArray, goal: PoseGoal | PositionGoal
) -> PlanningFailed:
    """Explain why no solution reaches the goal, with the nearest pose."""
    missed = study.answer.missed
    if study.answer.refused:
        return _all_refused(study, goal)
    if missed:
        return _constraints_violated(space, study, missed[0], goal)
    target = target_of(goal)
    reference = space.part(start)
    alone = PositionGoal(goal.link, target)
    nearest_point = nearest_pose(space, alone, reference)
    too_far = 0.0 if nearest_point.shift < _REACHED else nearest_point.shift
    nearest = nearest_pose(space, goal, nearest_point.positions)
    failure = IkFailure(
        position_error=nearest.shift,
        orientation_error=nearest.turn,
        point_out_of_reach_by=too_far,
        wrist_out_of_reach_by=study.answer.excess,
        nearest_position=tuple(nearest_point.pose.translation.tolist()),
    )
    if too_far:
        message = (
            f"{goal.link} cannot reach {point(target)} in world: the nearest point it reaches, "
            f"{point(nearest_point.pose.translation)}, is {length_text(too_far)} away"
        )
    elif nearest.shift + nearest.turn < _REACHED and not study.answer.outside_limits:
        solver = described(IkSolver.plugin_kind, study.answer.method)
        message = (
            f"{solver} finds no solution, but {goal.link} reaches {point(target)} as requested"
        )
    elif study.answer.outside_limits and nearest.shift + nearest.turn > _REACHED:
        ways = counted_noun(study.answer.outside_limits, "way")
        message = (
            f"{goal.link} would reach {point(target)} in {ways}, but only beyond the joint limits: "
            f"{_nearest_limit(space, study.answer.outside_limits)}"
        )
    else:
        what = "orientation" if isinstance(goal, PoseGoal) else "pitch"
        message = (
            f"{goal.link} reaches {point(target)} in world, but not with the requested {what}:"
            f" the nearest pose is {length_text(nearest.shift)} and {angle(nearest.turn)} away"
        )
    return PlanningFailed("NO_IK_SOLUTION", message, study.record, failure)


def _all_refused(study: GoalStudy, goal: PoseGoal | PositionGoal) -> PlanningFailed:
    """The failure of a third-party solver none of whose answers reaches the goal."""
    refused = study.answer.refused
    nearest = refused[0]
    solver = described(IkSolver.plugin_kind, study.answer.method)
    what = "answer" if len(refused) == 1 else f"nearest of {len(refused)} answers"
    turned = f" and {angle(nearest.turn)}" if nearest.turn else ""
    return PlanningFailed(
        "NO_IK_SOLUTION",
        f"{solver} is wrong: by forward kinematics its {what} puts {goal.link} "
        f"{length_text(nearest.shift)}{turned} away from {point(target_of(goal))}",
        study.record,
        IkFailure(nearest.shift, nearest.turn),
    )


def _constraints_violated(
    space: GroupSpace, study: GoalStudy, missed: NearestPose, goal: PoseGoal | PositionGoal
) -> PlanningFailed:
    """The failure of an arm with too few joints, which misses part of the pose."""
    turned_by = angle(missed.turn)
    write = "`position` and `pitch`" if "pitch" in study.answer.task else "`position`"
    return PlanningFailed(
        "GOAL_CONSTRAINTS_VIOLATED",
        f"with {space.dof} joints {goal.link} reaches the {study.answer.task} of the pose, but is "
        f"then turned {turned_by} away from it, and {_allowed_turn(goal)} are allowed: "
        f"give {write} instead of `pose`, or a wider `tolerance`",
        study.record,
        IkFailure(missed.shift, missed.turn),
    )


def _allowed_turn(goal: PoseGoal | PositionGoal) -> str:
    if isinstance(goal, PositionGoal):
        return angle(goal.pitch_tolerance)
    if goal.axis_tolerances is None:
        return angle(goal.orientation_tolerance)
    return ", ".join(map(angle, goal.axis_tolerances)) + " about x, y, z"


def _nearest_limit(space: GroupSpace, outside: Sequence[LimitedSolution]) -> str:
    nearest = min(outside, key=lambda solution: abs(solution.value - solution.limit))
    name, value, limit = nearest.joint, nearest.value, nearest.limit
    return (
        f"the nearest needs {name} at {joint_value(space, name, value)}, "
        f"{joint_value(space, name, abs(value - limit))} beyond its limit"
    )
