"""Plans Pilz's motion sequence: PTP, LIN and CIRC, blended into each other; all or nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.cartesian.line_goals import end_pose
from harness.planning.cartesian.linear_path import LinearPath
from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.link_timing import LinkRates
from harness.planning.goals.goals import find_goals
from harness.plugins.motions.circular_path import arc_to
from harness.plugins.motions.leg import Leg
from harness.plugins.motions.leg_run import runs_of, time_runs
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import SequenceItem
from harness.recording.motion_failures import SequenceFailure
from harness.recording.step_results import SequenceResult


def plan_items(motions: LinkMotions, items: Sequence[SequenceItem]) -> MotionPlan:
    """A verified motion through all items.

    Raises:
        PlanningFailed: The first item that cannot be carried out; says which.
    """
    task = motions.task
    legs: list[Leg] = []
    start = task.start
    for index, item in enumerate(items):
        name = f"item {index + 1} ({item.kind})"
        try:
            leg = _leg(motions, item, start)
        except PlanningFailed as failure:
            raise PlanningFailed(
                failure.code,
                f"{name}: {failure.message}",
                *failure.details,
                SequenceFailure(index),
            ) from failure
        leg.name = name
        legs.append(leg)
        start = leg.positions[-1]
    explanation = task.lowered_margins
    legs, radii = _moving(legs, [item.blend_radius for item in items[:-1]])
    if not legs:
        result = Details.of(SequenceResult(len(items), 0, 0))
        return task.stay("sequence", explanation, result)
    runs = runs_of(legs, radii, motions)
    result = Details.of(SequenceResult(len(items), len(runs) - 1, len(legs) - len(runs)))
    end = legs[-1].positions[-1]
    if task.options.path_only:
        return task.jump(end, explanation, result)
    trajectory = time_runs(runs, motions)
    task.accept(trajectory, end, "the sequence")
    waypoints = np.concatenate([leg.positions for leg in legs])
    return MotionPlan(
        trajectory,
        Details.of(task.statistics("sequence", trajectory, waypoints)),
        explanation,
        result,
    )


def _moving(legs: Sequence[Leg], radii: Sequence[float]) -> tuple[list[Leg], list[float]]:
    """The legs that move, and the smallest of the blend radii given between each two of them."""
    moving: list[Leg] = []
    corners: list[float] = []
    radius = np.inf
    for leg, after in zip(legs, [*radii, 0.0], strict=True):
        if not leg.is_still:
            if moving:
                corners.append(radius)
            moving.append(leg)
            radius = np.inf
        radius = min(radius, after)
    return moving, corners


def _leg(motions: LinkMotions, item: SequenceItem, start: FloatArray) -> Leg:
    task, kinematics = motions.task, motions.kinematics
    if item.kind == "ptp":
        whole = task.space.whole(start)
        found = find_goals(kinematics, task.checker, whole, item.goal, task.options.seed)
        link = kinematics.description.tcp_link
        link = link if isinstance(item.goal, JointGoal) else item.goal.link
        return Leg.straight(link, task.checker, found.positions[0], start)
    target = end_pose(kinematics, task, start, item.goal)
    now = motions.pose(start, target.link)
    if item.point is None:
        path = LinearPath.between(target.link, now, target.pose)
    else:
        path = arc_to(target, now, item.point)
    motions.solutions(start, target)
    traced = motions.followed(path, target, start)
    rates = LinkRates.of(item.cartesian_limits, task.options)
    return Leg(target.link, task.checker, traced.positions, path, rates)
