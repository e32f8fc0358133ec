"""Finds a free, verified motion to one of several goals: a straight one, or by a search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.registry import described, registry
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.collision import wording
from harness.planning.collision.checker import touch_records
from harness.planning.search.path_search import Effort, verified_paths
from harness.planning.search.shortening import shorten
from harness.planning.task import PlanningTask
from harness.planning.timing.timing import (
    BlendedPath,
    TimingError,
    time_blended,
    time_stopping,
    time_straight,
)
from harness.planning.verification.verify import (
    FINAL_RESOLUTION,
    VERIFIED_RESOLUTION,
    Defect,
    distances_to_path,
    find_departure,
    path_collision,
)
from harness.ports.motion_planning import MotionPlan, PlanningOptions
from harness.ports.path_planning import PathPlanner
from harness.recording.goal_failures import IkStudy
from harness.recording.motion_failures import BlockedWay, PipelineFailure, SearchFailure
from harness.recording.plan_statistics import DIRECT, PlanStatistics, SearchStatistics

BLEND_DEVIATIONS = (0.05, 0.01)
"""Largest deviations of the blends at the corners [rad]; after these, the motion stops there."""

CHEAPER = 0.95
"""Largest effort of a motion to another solution that is searched, as a share of the one found."""

CHEAPER_CHECKS = 10_000
"""State checks of the search for cheaper solutions; as many as the first search used, if more, but
at most the budget of a search."""


@dataclass(frozen=True, eq=False)
class _Motion:
    """A verified motion, its end, its effort (weighted joint-space length), and its statistics."""

    trajectory: JointTrajectory
    end: FloatArray
    effort: float
    statistics: PlanStatistics
    search: SearchStatistics | None = None


def find_motion(
    task: PlanningTask, goals: Sequence[FloatArray], explanation: Details
) -> MotionPlan:
    """Plan a verified motion from the task's start to the goal with the least effort.

    The effort is the joint-space length weighted by the leverage of the joints. The first candidate
    is a free straight motion, or else the result of a search to any of the goals. Goals whose
    straight effort is less than the candidate's are then searched with a small budget.

    Args:
        explanation: The explanation of the goals; the plan contains it with the chosen solution.

    Raises:
        PlanningFailed: PLANNING_FAILED, when the budget is used up; INVALID_MOTION_PLAN, when no
            path passes verification.
        TimingError: The arm cannot stand still where it starts, or at any goal.
    """
    goals = task.can_stand(goals)
    try:
        found = _straight(task, goals) or _searched(task, goals, explanation)
        found = _cheapest(task, goals, found)
    except ValueError as problem:  # a pipeline, a planner or a parameter is unknown
        raise PlanningFailed("PLANNING_FAILED", str(problem)) from problem
    checked = replace(found.statistics, state_checks=task.checker.checks)
    statistics = Details.of(checked, found.search)
    return MotionPlan(found.trajectory, statistics, _chosen(explanation, found.end))


def _straight(task: PlanningTask, goals: Sequence[FloatArray]) -> _Motion | None:
    """A verified straight motion to the first goal for which there is one, or None."""
    space, checker = task.space, task.checker
    for end in goals:
        ends = np.array([task.start, end])
        if checker.edge_free(task.start, end, FINAL_RESOLUTION) and task.overload(ends) is None:
            trajectory = time_straight(space.joint_names, task.start, end, task.limits)
            if task.defect(trajectory, end) is None:
                statistics = task.statistics(DIRECT, trajectory, ends)
                return _Motion(trajectory, end, space.effort(task.start, end), statistics)
    return None


def _searched(task: PlanningTask, goals: Sequence[FloatArray], explanation: Details) -> _Motion:
    """Search, shorten, time and verify."""
    effort = Effort()
    found = _first_verified_motion(task, goals, task.options, effort)
    if isinstance(found, _Motion):
        return found
    raise _search_failure(task, goals, explanation, effort, found)


def _cheapest(task: PlanningTask, goals: Sequence[FloatArray], found: _Motion) -> _Motion:
    """The motion found, or a motion to another goal with less effort."""
    searched = (found.search and found.search.search_checks) or 0
    budget = min(max(CHEAPER_CHECKS, searched), task.options.max_state_checks)
    untried = _other_goals(goals, found)
    while budget > 0:
        most = CHEAPER * found.effort
        untried = [goal for goal in untried if task.space.effort(task.start, goal) < most]
        if not untried:
            break
        effort = Effort()
        options = replace(task.options, max_state_checks=budget, attempts=1)
        other = _first_verified_motion(task, untried, options, effort)
        if not isinstance(other, _Motion):
            break
        budget -= effort.checks
        untried = _other_goals(untried, other)
        found = other if other.effort < most else found
    return found


def _other_goals(goals: Sequence[FloatArray], found: _Motion) -> list[FloatArray]:
    return [goal for goal in goals if not np.allclose(goal, found.end, atol=1e-9)]


def _first_verified_motion(
    task: PlanningTask, goals: Sequence[FloatArray], options: PlanningOptions, effort: Effort
) -> _Motion | Defect | None:
    """The first path that becomes a verified motion; otherwise the defect of the last path.

    Raises:
        ValueError: A planner or a parameter is unknown.
    """
    defect: Defect | None = None
    for found, path in verified_paths(task.checker, task.start, goals, options, effort):
        short = shorten(path, task.checker, VERIFIED_RESOLUTION, found.seed)
        try:
            timed = task.overload(short) or _timed(task, short)
        except TimingError as problem:
            timed = Defect(str(problem), problem.details)
        if not isinstance(timed, Defect):
            trajectory, away = timed
            moved = sum(task.space.effort(*edge) for edge in pairwise(short))
            statistics = task.statistics(found.planner_id, trajectory, short, path)
            search = SearchStatistics(
                effort.attempts, effort.checks, found.vertices, VERIFIED_RESOLUTION, away
            )
            return _Motion(trajectory, short[-1], moved, statistics, search)
        defect = timed
    return defect


def _timed(task: PlanningTask, waypoints: FloatArray) -> tuple[JointTrajectory, float] | Defect:
    """Time a path with the largest blends that pass verification, or stops; and its deviation."""
    names, end = task.space.joint_names, waypoints[-1]
    if len(waypoints) == 2:
        trajectory = time_straight(names, waypoints[0], end, task.limits)
        return task.defect(trajectory, end) or (trajectory, 0.0)
    for blend in BLEND_DEVIATIONS:
        path = BlendedPath(waypoints, blend)
        if not all(task.checker.path_free(each, FINAL_RESOLUTION) for each in path.blends()):
            continue  # what is timed is verified; this saves the times of most that would fail
        try:
            trajectory = time_blended(names, path, task.limits)
        except TimingError:
            continue
        away = distances_to_path(trajectory.positions, waypoints)
        departure = find_departure(trajectory, away, blend)
        if departure is None and task.defect(trajectory, end) is None:
            return trajectory, float(away.max())
    blocked = path_collision(waypoints, task.checker, VERIFIED_RESOLUTION)
    if blocked is not None:
        return blocked
    trajectory = time_stopping(names, waypoints, task.limits)
    departure = find_departure(trajectory, distances_to_path(trajectory.positions, waypoints), 0.0)
    return departure or task.defect(trajectory, end) or (trajectory, 0.0)


def _search_failure(
    task: PlanningTask,
    goals: Sequence[FloatArray],
    explanation: Details,
    effort: Effort,
    defect: Defect | None,
) -> PlanningFailed:
    pipeline = task.options.pipeline
    who = described(PathPlanner.plugin_kind, pipeline)
    is_plugin = not registry(PathPlanner.plugin_kind).is_own(pipeline)
    owner = Details.of(PipelineFailure(pipeline) if is_plugin else None)
    if defect is not None:
        whose = f"paths of {who}" if is_plugin else "paths"
        return PlanningFailed(
            "INVALID_MOTION_PLAN",
            f"{whose} were found, but none passes verification: {defect.message}",
            *explanation,
            *owner,
            *defect.details,
        )
    options = task.options
    attempts = "" if options.attempts == 1 else f"{options.attempts} searches with "
    by_whom = f" by {who}" if is_plugin else ""
    message = (
        f"no free path to the goal was found{by_whom} in {attempts}at most "
        f"{options.max_state_checks} state checks"
    )
    straight_way = None
    straight = np.array([task.start, goals[0]])
    blocked = task.checker.first_block(straight, FINAL_RESOLUTION)
    if blocked is not None:
        share, _, touches = blocked
        straight_way = BlockedWay(share, touch_records(touches))
        message += (
            f"; the direct joint motion is blocked after {100 * share:.0f} % by "
            f"{wording.touches(touches)}"
        )
    search = SearchFailure(effort.checks, min(effort.gaps, default=None), straight_way)
    return PlanningFailed("PLANNING_FAILED", message, *explanation, *owner, search)


def _chosen(explanation: Details, end: FloatArray) -> Details:
    """The explanation, with the status `chosen` for the solution at the end of the motion."""
    study = explanation.find(IkStudy)
    if study is None:
        return explanation
    marked = tuple(
        replace(solution, status="chosen")
        if np.allclose(solution.joint_positions, end, atol=1e-9)
        else solution
        for solution in study.ik_solutions
    )
    return explanation.replaced(replace(study, ik_solutions=marked))
