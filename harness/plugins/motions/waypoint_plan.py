"""Plans MoveIt's Cartesian path: lines through waypoints, and the fraction that is feasible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.cartesian.line_goals import end_pose
from harness.planning.cartesian.linear_path import LinearPath
from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.link_timing import LinkRates
from harness.planning.cartesian.tracing import STEP_ANGLE, STEP_LENGTH, Trace, trace
from harness.plugins.motions.leg import Leg
from harness.plugins.motions.leg_run import runs_of, time_runs
from harness.ports.goals import Goal
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import CartesianPathOptions
from harness.recording.explanation import StraightResult
from harness.recording.step_results import CartesianPathResult

CORNER_SHARE = 0.45
"""Largest part of the shorter adjacent line that the rounding of a corner may use."""


def plan_waypoints(
    motions: LinkMotions, goals: Sequence[Goal], path_options: CartesianPathOptions
) -> MotionPlan:
    """Plan a verified motion of the link through poses, with corners rounded within the precision.

    Raises:
        PlanningFailed: PLANNING_FAILED, when less than the required fraction is feasible;
            INVALID_MOTION_PLAN, when the timed motion deviates from its lines by more than the
            precision.
    """
    task = motions.task
    legs, lines, steps, stopped = _follow(motions, goals, path_options)
    whole = sum(_amount(line) for line in lines)
    done = sum(_amount(leg.path) for leg in legs if isinstance(leg.path, LinearPath))
    fraction = 1.0 if stopped is None else done / whole
    result = CartesianPathResult(fraction, max(steps, default=0.0))
    if fraction < path_options.min_fraction:
        why = "" if stopped is None else f": {stopped.stop}"
        least = f"{100 * path_options.min_fraction:.0f} %"
        raise PlanningFailed(
            "PLANNING_FAILED",
            f"{lines[0].link} can follow {100 * fraction:.1f} % of its path, at least {least} is "
            f"required{why}",
            replace(result, min_fraction=path_options.min_fraction),
            *Details.of(None if stopped is None else stopped.failure),
        )
    explanation = task.lowered_margins + Details.of(
        StraightResult("" if stopped is None else stopped.stop)
    )
    if not legs:
        return task.stay("cartesian_path", explanation, Details.of(replace(result, deviation=0.0)))
    runs = runs_of(legs, _radii(legs, path_options.precision), motions)
    end = legs[-1].positions[-1]
    if task.options.path_only:
        return task.jump(end, explanation, Details.of(result))
    trajectory = time_runs(runs, motions)
    task.accept(trajectory, end, "the Cartesian path")
    deviation = _deviation(legs, trajectory, motions)
    result = replace(result, deviation=deviation)
    if deviation > path_options.precision:
        raise PlanningFailed(
            "INVALID_MOTION_PLAN",
            f"{lines[0].link} would deviate from its lines by {1000 * deviation:.2f} mm, "
            f"more than the precision of {1000 * path_options.precision:.2f} mm",
            result,
        )
    waypoints = np.concatenate([leg.positions for leg in legs])
    statistics = Details.of(task.statistics("cartesian_path", trajectory, waypoints))
    return MotionPlan(trajectory, statistics, explanation, Details.of(result))


def _follow(
    motions: LinkMotions, goals: Sequence[Goal], path_options: CartesianPathOptions
) -> tuple[list[Leg], list[LinearPath], list[float], Trace | None]:
    """The lines followed, all lines, the largest joint steps, and the trace that was stopped."""
    task = motions.task
    rates = LinkRates.of(task.options.cartesian_limits, task.options)
    legs: list[Leg] = []
    lines: list[LinearPath] = []
    steps: list[float] = []
    stopped: Trace | None = None
    start = task.start
    pose = None
    for index, goal in enumerate(goals):
        target = end_pose(motions.kinematics, task, start, goal)
        pose = pose or motions.pose(start, target.link)
        line = LinearPath.between(target.link, pose, target.pose)
        pose = target.pose
        if line.is_point:
            continue
        lines.append(line)
        if stopped is not None:
            continue
        traced = trace(line, task.checker, start, path_options.max_step, path_options.jump)
        if not traced.reached_end:
            stopped = traced
            if traced.share <= 0:
                continue
            line = line.part(traced.share)
            traced = trace(line, task.checker, start, path_options.max_step, path_options.jump)
            if not traced.reached_end:
                continue
        if not task.space.task_space.holds_pose:
            pose = motions.pose(traced.positions[-1], line.link)
        name = f"the line to waypoint {index + 1}"
        legs.append(Leg(line.link, task.checker, traced.positions, line, rates, name))
        steps.append(_largest_step(traced))
        start = traced.positions[-1]
    return legs, lines, steps, stopped


def _amount(line: LinearPath) -> float:
    """The size of a line: its length, or its rotation converted by the ratio of the steps [m]."""
    return max(line.length, line.angle * STEP_LENGTH / STEP_ANGLE)


def _radii(legs: Sequence[Leg], precision: float) -> list[float]:
    """Blend radius of each corner; the deviation is less than half of it."""
    lengths = [leg.path.length if leg.path is not None else 0.0 for leg in legs]
    return [
        min(1.8 * precision, CORNER_SHARE * min(before, after))
        for before, after in pairwise(lengths)
    ]


def _deviation(legs: Sequence[Leg], trajectory: JointTrajectory, motions: LinkMotions) -> float:
    """Largest distance of the link from the nearest line over all samples [m]."""

    def off(positions: FloatArray) -> float:
        pose = motions.pose(positions, legs[0].link)
        places = [
            leg.path.pose(min(max(leg.path.nearest(pose)[0], 0.0), 1.0)).translation
            for leg in legs
            if leg.path is not None
        ]
        return min(float(np.linalg.norm(place - pose.translation)) for place in places)

    return max(off(positions) for positions in trajectory.positions)


def _largest_step(traced: Trace) -> float:
    """Farthest that a joint moves within one requested step of a trace [rad or m]."""
    stride = min(traced.stride, len(traced.positions) - 1)
    if stride < 1:
        return 0.0
    return float(np.abs(traced.positions[stride:] - traced.positions[:-stride]).max())
