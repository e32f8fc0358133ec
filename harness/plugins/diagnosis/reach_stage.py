"""Explains reach: the pose nearest to an unreachable goal, and a reachable alternative."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.core.spatial import SE3, xyzw_from_wxyz
from harness.core.types import FloatArray
from harness.planning.collision.wording import angle, length_text, point
from harness.planning.goals.goal_study import GoalStudy
from harness.planning.ik.nearest_pose import (
    KEEP_POINT,
    KEEP_TURN,
    NearestPose,
    nearest_pose,
    target_of,
)
from harness.planning.ik.numeric import LinkGoal
from harness.plugins.diagnosis.stage_request import StageFinding, StageRequest, nearest_state
from harness.ports.goals import PoseGoal, PositionGoal
from harness.recording.explanation import Stage

_KEPT = 1e-3  # [m, rad] an alternative that misses by less keeps what it should
_STEPS_BACK = (0.0, 0.001, 0.002, 0.005, 0.01, 0.02)  # [m] from the edge of the reach


def reach_finding(request: StageRequest, goal: LinkGoal, study: GoalStudy) -> StageFinding:
    """Whether the arm reaches the goal; otherwise the nearest pose and a reachable goal."""
    target = point(target_of(goal))
    if study.answer.solutions:
        text = f"{goal.link} reaches {target} as requested"
        if study.answer.task != "pose" and isinstance(goal, PoseGoal):
            shift, turn = study.branches[0].residual
            if shift > _KEPT or turn > _KEPT:
                text += f", except for {length_text(shift)} and {angle(turn)}"
        return StageFinding(Stage("reach", "passed", text))
    if study.answer.missed:
        return _too_few_joints(request, goal, study)
    nearest = nearest_pose(request.space, goal, request.space.part(request.start))
    if nearest.is_reached:
        return StageFinding(Stage("reach", "passed", f"{goal.link} reaches {target} as requested"))
    others = dict(_alternatives(request, goal, nearest))
    stage = Stage(
        "reach",
        "failed",
        f"nearest reachable pose: {point(nearest.pose.translation)}, {_away(goal, nearest)} away",
        "NO_IK_SOLUTION",
        tuple(f"{how}: {_describe(how, other)}" for how, other in others.items()),
    )
    advice = _reached_goal(request, goal, others.get(_SAME_ORIENTATION, nearest))
    return StageFinding(stage, nearest_state(request, goal, nearest), advice)


def _too_few_joints(request: StageRequest, goal: LinkGoal, study: GoalStudy) -> StageFinding:
    nearest, task = study.answer.missed[0], study.answer.task
    stage = Stage(
        "reach",
        "failed",
        f"nearest reachable pose: {point(nearest.pose.translation)}, {_away(goal, nearest)} away",
        "GOAL_CONSTRAINTS_VIOLATED",
        (f"of {request.space.dof} joints: the {task} of the pose are solved for",),
    )
    keys = "`position` and `pitch`" if "pitch" in task else "`position`"
    tolerance = np.ceil(1000 * nearest.turn + 0.5) / 1000
    advice = (
        f"give {keys} instead of `pose`, or allow `tolerance: {{orientation: {tolerance:.3f}}}`"
    )
    return StageFinding(stage, nearest_state(request, goal, nearest), advice)


_SAME_ORIENTATION = "with the requested orientation"
_ANY_ORIENTATION = "with any orientation"
_SAME_POSITION = "at the requested position"


def _alternatives(
    request: StageRequest, goal: LinkGoal, nearest: NearestPose
) -> Iterator[tuple[str, NearestPose]]:
    """The nearest poses with the requested orientation, any orientation, the requested position."""
    space = request.space
    if isinstance(goal, PositionGoal) and goal.pitch is None:
        return
    here = nearest.positions
    kept = nearest_pose(space, goal, here, metres_per_radian=KEEP_TURN)
    if kept.turn < _KEPT:
        yield _SAME_ORIENTATION, kept
    alone = PositionGoal(goal.link, target_of(goal))
    free = nearest_pose(space, alone, here)
    if free.shift > _KEPT:
        yield _ANY_ORIENTATION, free
        return
    there = nearest_pose(space, goal, free.positions, metres_per_radian=KEEP_POINT)
    if there.shift < _KEPT:
        yield _SAME_POSITION, there


def _describe(how: str, other: NearestPose) -> str:
    if how == _SAME_POSITION:
        return f"{angle(other.turn)} away"
    return f"{point(other.pose.translation)}, {length_text(other.shift)} away"


def _reached_goal(request: StageRequest, goal: LinkGoal, near: NearestPose) -> str:
    """Advice with a reachable goal near this one, rounded and verified by inverse kinematics."""
    way = near.pose.translation - target_of(goal)
    way /= max(float(np.linalg.norm(way)), 1e-9)
    is_pose = isinstance(goal, PoseGoal)
    kept_turn = is_pose and goal.pose.distance_to(near.pose)[1] < _KEPT
    rotation = goal.pose.rotation if is_pose and kept_turn else near.pose.rotation
    quat = np.round(SE3(rotation, way).quat_wxyz, 5) + 0.0
    for back in _STEPS_BACK:
        xyz = np.round(near.pose.translation + back * way, 3) + 0.0
        moved = (
            replace(goal, pose=SE3.from_xyz_quat(xyz, quat))
            if isinstance(goal, PoseGoal)
            else replace(goal, position=xyz)
        )
        seed = request.options.seed
        if not request.kinematics.analyse(request.space, moved, request.start, seed).solutions:
            continue
        value = f"frame: world, xyz: [{_numbers(xyz)}]"
        if is_pose:
            value += f", quat_xyzw: [{_numbers(xyzw_from_wxyz(quat))}]"
        turned = ", with the requested orientation" if kept_turn else ""
        key = "pose" if is_pose else "position"
        return f"`{key}: {{{value}}}` is reached{turned}; or bring base and goal nearer together"
    return "bring base and goal nearer together, or turn the goal"


def _numbers(values: FloatArray) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _away(goal: LinkGoal, nearest: NearestPose) -> str:
    """`14.0 mm and 18.8°`; only one of them where the other is zero."""
    if nearest.turn < 1e-4 or (isinstance(goal, PositionGoal) and goal.pitch is None):
        return length_text(nearest.shift)
    if nearest.shift < 1e-5:
        return angle(nearest.turn)
    return f"{length_text(nearest.shift)} and {angle(nearest.turn)}"
