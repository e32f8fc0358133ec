"""Finds a free, verified motion to one of several goals: straight if it can, else searched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.checker import describe_touches, touch_facts
from harness.planning.path_search import Effort, FoundPath, verified_paths
from harness.planning.shortening import shorten
from harness.planning.task import PlanningTask
from harness.planning.timing import TimingError, time_blended, time_stopping, time_straight
from harness.planning.verify import (
    FINAL_RESOLUTION,
    Defect,
    distances_to_path,
    find_departure,
    verified_resolution,
)
from harness.ports import MotionPlan

BLEND_DEVIATIONS = (0.05, 0.01)
"""How far the timed path may leave the checked one at its corners [rad]; then it stops there."""

LONGEST_DETOUR = 2.0
"""A straight way to a farther solution is taken only up to this many times the nearest's length."""


def find_motion(
    task: PlanningTask, goals: Sequence[FloatArray], explanation: dict[str, Any]
) -> MotionPlan:
    """A verified motion from the task's start to one of the goals.

    Args:
        task: What is asked.
        goals: Free group positions, nearest first.
        explanation: Of the goals; the plan carries it on, the solution taken marked.

    Raises:
        PlanningFailed: PLANNING_FAILED (budget used up), INVALID_MOTION_PLAN (nothing found holds).
    """
    straight = _straight(task, goals)
    if straight is None:
        return _searched(task, goals, explanation)
    end, trajectory = straight
    statistics = task.statistics("straight line", trajectory, [task.start, end])
    return MotionPlan(trajectory, statistics, _chosen(explanation, end))


def _straight(
    task: PlanningTask, goals: Sequence[FloatArray]
) -> tuple[FloatArray, JointTrajectory] | None:
    """A verified straight motion to the first goal that has one, or None."""
    space, checker = task.space, task.checker
    nearest = space.effort(task.start, goals[0])
    for end in goals:
        if space.effort(task.start, end) > LONGEST_DETOUR * nearest + 1e-9:
            break
        if checker.edge_free(task.start, end, FINAL_RESOLUTION):
            trajectory = time_straight(space.joint_names, task.start, end, task.limits)
            if task.defect(trajectory, end) is None:
                return end, trajectory
    return None


def _searched(
    task: PlanningTask, goals: Sequence[FloatArray], explanation: dict[str, Any]
) -> MotionPlan:
    """Search, shorten, time and verify; finer when verification finds something."""
    effort = Effort()
    defect: Defect | None = None
    try:
        for found in verified_paths(task.checker, task.start, goals, task.options, effort):
            for resolution in (FINAL_RESOLUTION, verified_resolution(task.checker.padding)):
                short = shorten(found.waypoints, task.checker, resolution, found.seed)
                timed = _timed(task, short)
                if isinstance(timed, JointTrajectory):
                    statistics = _statistics(task, found, effort, short, timed)
                    return MotionPlan(timed, statistics, _chosen(explanation, short[-1]))
                defect = timed
    except ValueError as problem:
        raise PlanningFailed("PLANNING_FAILED", str(problem)) from problem
    raise _not_found(task, goals, explanation, effort.checks, effort.gaps, defect)


def _statistics(
    task: PlanningTask,
    found: FoundPath,
    effort: Effort,
    short: FloatArray,
    timed: JointTrajectory,
) -> dict[str, Any]:
    away = distances_to_path(timed.positions, short)
    return {
        **task.statistics(found.result.planner_id, timed, short, found.waypoints),
        "attempts": found.attempt + 1,
        "search_checks": effort.checks,
        "vertices": found.result.vertices,
        "resolution": found.resolution,
        "path_deviation": float(away.max()),
    }


def _timed(task: PlanningTask, waypoints: FloatArray) -> JointTrajectory | Defect:
    """The fastest of three ways to time a path that passes verification."""
    names, end = task.space.joint_names, waypoints[-1]
    if len(waypoints) == 2:
        trajectory = time_straight(names, waypoints[0], end, task.limits)
        return task.defect(trajectory, end) or trajectory
    for blend in BLEND_DEVIATIONS:
        try:
            trajectory = time_blended(names, waypoints, task.limits, blend)
        except TimingError:
            continue
        departure = find_departure(trajectory, waypoints, blend)
        if departure is None and task.defect(trajectory, end) is None:
            return trajectory
    trajectory = time_stopping(names, waypoints, task.limits)
    departure = find_departure(trajectory, waypoints, 0.0)
    return departure or task.defect(trajectory, end) or trajectory


def _not_found(
    task: PlanningTask,
    goals: Sequence[FloatArray],
    explanation: dict[str, Any],
    used: int,
    gaps: list[float],
    defect: Defect | None,
) -> PlanningFailed:
    if defect is not None:
        return PlanningFailed(
            "INVALID_MOTION_PLAN",
            "paths were found, but none that holds when it is checked finely: " + defect.message,
            {**explanation, **defect.facts},
        )
    options = task.options
    attempts = "" if options.attempts == 1 else f"{options.attempts} searches with "
    message = (
        f"no free path to the goal was found in {attempts}at most {options.max_state_checks} "
        "state checks"
    )
    facts: dict[str, Any] = {**explanation, "state_checks": used}
    if gaps:
        facts["gap"] = min(gaps)
    blocked = task.checker.first_block(task.start, goals[0], FINAL_RESOLUTION)
    if blocked is not None:
        share, touches = blocked
        facts["straight_way"] = {"free_share": share, "touches": touch_facts(touches)}
        message += (
            f"; the straight way is blocked after {100 * share:.0f} % by "
            f"{describe_touches(touches)}"
        )
    return PlanningFailed("PLANNING_FAILED", message, facts)


def _chosen(explanation: dict[str, Any], end: FloatArray) -> dict[str, Any]:
    """The explanation with the solution that was taken marked."""
    solutions = explanation.get("ik_solutions")
    if not solutions:
        return explanation
    marked = [
        {**solution, "status": "chosen"}
        if np.allclose(solution["joint_positions"], end, atol=1e-9)
        else solution
        for solution in solutions
    ]
    return {**explanation, "ik_solutions": marked}
