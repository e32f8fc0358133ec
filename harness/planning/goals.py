"""Turns a goal into joint positions that reach it, and says what became of each candidate."""

from __future__ import annotations

from collections.abc import Sized
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.checker import MotionChecker, describe_touches, touch_facts
from harness.planning.ik_numeric import LinkGoal, nearest_attempt, pitch_of
from harness.planning.kinematics import IkAnswer, LimitedSolution, PinocchioKinematics
from harness.planning.robot_model import GroupSpace
from harness.ports import Goal, JointGoal, PoseGoal, PositionGoal, Touch

MOST_GOALS = 8
"""Inverse kinematics' solutions that are checked and planned to, nearest first."""

_REACHED = 1e-6  # [m] a nearest attempt this near has reached the point


@dataclass(frozen=True, eq=False)
class GoalCandidates:
    """Joint positions that reach a goal and are free, nearest first, with the explanation."""

    positions: tuple[FloatArray, ...]
    explanation: dict[str, Any]


def find_goals(
    kinematics: PinocchioKinematics,
    checker: MotionChecker,
    start: FloatArray,
    goal: Goal,
    seed: int,
) -> GoalCandidates:
    """Free joint positions that reach a goal.

    Args:
        kinematics: Of the robot.
        checker: Of the motion that is to be planned.
        start: Description order.
        goal: What is wanted.
        seed: Of numeric restarts.

    Raises:
        PlanningFailed: GOAL_STATE_INVALID (joints outside their limits), NO_IK_SOLUTION,
            GOAL_IN_COLLISION, INVALID_LINK_NAME; each with its numbers.
    """
    if isinstance(goal, JointGoal):
        return _joint_goal(checker, goal)
    space = checker.space
    answer = kinematics.analyse(space, goal, start, seed)
    if not answer.solutions:
        raise _no_solution(space, answer, start, goal, seed)
    reference = space.part(start)
    free: list[FloatArray] = []
    facts: list[dict[str, Any]] = []
    first_touches: list[Touch] = []
    for positions in answer.solutions[:MOST_GOALS]:
        touches = [] if checker.state_free(positions) else checker.touches(positions)
        facts.append(
            {
                "joint_positions": [float(value) for value in positions],
                "distance": space.distance(reference, positions),
                "status": "in collision" if touches else "free",
                "touches": touch_facts(touches),
            }
        )
        first_touches = first_touches or touches
        if not touches:
            free.append(positions)
    explanation = {
        "ik_method": answer.method,
        "ik_solutions": facts,
        "outside_limits": [solution.facts() for solution in answer.outside_limits],
    }
    if not free:
        raise PlanningFailed(
            "GOAL_IN_COLLISION",
            f"the goal of {goal.link} can be reached in {_count(facts, 'way')}, each of them in "
            f"collision; the nearest: {describe_touches(first_touches)}"
            + _limits_sentence(answer.outside_limits),
            explanation,
        )
    return GoalCandidates(tuple(free), explanation)


def _joint_goal(checker: MotionChecker, goal: JointGoal) -> GoalCandidates:
    space = checker.space
    positions = np.asarray(goal.positions, dtype=float)
    broken = [
        {
            "joint": name,
            "value": float(value),
            "lower": float(low),
            "upper": float(high),
            "excess": float(max(low - value, value - high)),
        }
        for name, value, low, high in zip(
            space.joint_names, positions, space.lower, space.upper, strict=True
        )
        if not low - 1e-9 <= value <= high + 1e-9
    ]
    if broken:
        worst = broken[0]
        raise PlanningFailed(
            "GOAL_STATE_INVALID",
            f"{worst['joint']} cannot be at {worst['value']:.4f}: its limits are "
            f"{worst['lower']:.4f} to {worst['upper']:.4f}, which is {worst['excess']:.4f} too far"
            + (f"; {len(broken) - 1} more joints are outside theirs" if len(broken) > 1 else ""),
            {"outside_limits": broken},
        )
    positions = np.clip(positions, space.lower, space.upper)
    if not checker.state_free(positions):
        touches = checker.touches(positions)
        raise PlanningFailed(
            "GOAL_IN_COLLISION",
            f"at the goal's joint positions these are in collision: {describe_touches(touches)}",
            {"touches": touch_facts(touches)},
        )
    return GoalCandidates((positions,), {})


def _no_solution(
    space: GroupSpace,
    answer: IkAnswer,
    start: FloatArray,
    goal: LinkGoal,
    seed: int,
) -> PlanningFailed:
    """Say why nothing reaches the goal, and what comes nearest."""
    reference = space.part(start)
    target = goal.pose.translation if isinstance(goal, PoseGoal) else goal.position
    point = PositionGoal(goal.link, np.asarray(target, dtype=float))
    _, nearest_point = nearest_attempt(space, point, reference, seed)
    too_far = float(np.linalg.norm(nearest_point.translation - target))
    facts: dict[str, Any] = {
        "ik_method": answer.method,
        "ik_solutions": [],
        "outside_limits": [solution.facts() for solution in answer.outside_limits],
        "point_out_of_reach_by": 0.0 if too_far < _REACHED else too_far,
        "wrist_out_of_reach_by": answer.excess,
    }
    if too_far >= _REACHED:
        message = (
            f"{goal.link} cannot reach ({_xyz(target)}): the nearest point it reaches, "
            f"({_xyz(nearest_point.translation)}), is {1000 * too_far:.1f} mm away"
        )
        facts["nearest_position"] = nearest_point.translation.tolist()
        return PlanningFailed(
            "NO_IK_SOLUTION", message + _limits_sentence(answer.outside_limits), facts
        )
    positions, nearest = nearest_attempt(space, goal, reference, seed)
    facts["nearest_joint_positions"] = positions.tolist()
    facts["nearest_position"] = nearest.translation.tolist()
    facts["nearest_quat_wxyz"] = nearest.quat_wxyz.tolist()
    if isinstance(goal, PoseGoal):
        shift, angle = goal.pose.distance_to(nearest)
        what = "orientation"
    else:
        shift = float(np.linalg.norm(nearest.translation - target))
        angle = abs(pitch_of(nearest.rotation) - float(goal.pitch or 0.0))
        what = "pitch"
    facts["position_error"], facts["orientation_error"] = shift, angle
    message = (
        f"{goal.link} can reach ({_xyz(target)}), but not with the {what} asked for: the nearest "
        f"pose found is {1000 * shift:.1f} mm and {angle:.4f} rad ({np.degrees(angle):.1f}°) away"
    )
    if space.dof < 6 and isinstance(goal, PoseGoal):
        message += (
            f"; with {space.dof} joints only the position and the pitch can be chosen: give "
            "`position` and `pitch` instead of `pose`"
        )
    return PlanningFailed(
        "NO_IK_SOLUTION", message + _limits_sentence(answer.outside_limits), facts
    )


def _limits_sentence(outside: tuple[LimitedSolution, ...]) -> str:
    if not outside:
        return ""
    nearest = min(outside, key=lambda solution: abs(solution.value - solution.limit))
    excess = abs(nearest.value - nearest.limit)
    return (
        f"; {_count(outside, 'more solution')} outside the joint limits, the nearest with "
        f"{nearest.joint} at {nearest.value:.3f}, {excess:.3f} beyond its limit {nearest.limit:.3f}"
    )


def _count(things: Sized, noun: str) -> str:
    number = len(things)
    return f"{number} {noun}" + ("" if number == 1 else "s")


def _xyz(point: FloatArray) -> str:
    return ", ".join(f"{value:.3f}" for value in point)
