"""Explains inverse kinematics: each branch, and why it is ruled out."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from harness.core.registry import described, registry
from harness.core.types import FloatArray
from harness.planning.collision.checker import touch_records
from harness.planning.collision.wording import (
    counted_noun,
    joint_value,
    length_text,
    touches,
)
from harness.planning.goals.goal_study import GoalStudy
from harness.planning.ik.nearest_pose import NearestPose
from harness.planning.ik.numeric import LinkGoal
from harness.plugins.diagnosis.free_shift import SHIFTS, nearest_free_shift
from harness.plugins.diagnosis.motion_stages import padding_advice
from harness.plugins.diagnosis.stage_request import StageFinding, StageRequest, nearest_state
from harness.ports.kinematics import IkSolver
from harness.recording.explanation import FreeShift, NearestState, Stage

MOST_DETAILS = 8  # Number of branches that are listed individually


def branches_finding(request: StageRequest, goal: LinkGoal, study: GoalStudy) -> StageFinding:
    """The result of every branch: free, in collision, or beyond a joint limit, with the numbers."""
    answer = study.answer
    solver: type[IkSolver] = registry(IkSolver.plugin_kind)[answer.method]
    method = solver.title or described(IkSolver.plugin_kind, answer.method)
    kind = f"{method}, solved for the {answer.task}"
    if answer.refused and not answer.solutions:
        text = f"{counted_noun(answer.refused, 'answer')} refused by forward kinematics ({kind})"
        advice = f"correct the plug-in `{answer.method}`, or give the robot another `ik_solver`"
        stage = Stage("inverse kinematics", "failed", text, "NO_IK_SOLUTION")
        return StageFinding(stage, advice=advice)
    if not answer.solutions and not answer.outside_limits:
        return StageFinding(Stage("inverse kinematics", "skipped", f"no branch ({kind})"))
    free = sum(not branch.touches for branch in study.branches)
    ruled_out = {
        "in collision": len(study.branches) - free,
        "beyond a joint limit": len(answer.outside_limits),
        "refused by forward kinematics": len(answer.refused),
        "more distant ones not checked": study.unchecked,
    }
    counted = [f"{free} free", *(f"{number} {why}" for why, number in ruled_out.items() if number)]
    total = counted_noun(len(answer.solutions) + len(answer.outside_limits), "branch")
    text = f"{total} ({kind}): {', '.join(counted)}"
    details = _branch_lines(request, study)
    if free:
        return StageFinding(Stage("inverse kinematics", "passed", text, "", details))
    if not study.branches:
        stage = Stage("inverse kinematics", "failed", text, "NO_IK_SOLUTION", details)
        return StageFinding(
            stage, None, "turn or move the goal, so that every joint is inside its limits"
        )
    stage = Stage("inverse kinematics", "failed", text, "GOAL_IN_COLLISION", details)
    return StageFinding(stage, *_in_collision(request, goal, study))


def _branch_lines(request: StageRequest, study: GoalStudy) -> tuple[str, ...]:
    """Each branch, and why it is ruled out; joint positions distinguish those of one name."""
    outside = study.answer.outside_limits
    counts = Counter([*(branch.name for branch in study.branches), *study.outside])

    def title(number: int, name: str, positions: FloatArray) -> str:
        if not name:
            return f"solution {number}"
        values = ", ".join(f"{value + 0.0:.3f}" for value in np.round(positions, 3))
        return f"{name} [{values}]" if counts[name] > 1 else name

    lines = [
        f"{title(number, branch.name, branch.positions)}: "
        + (touches(branch.touches, most=1) if branch.touches else "free")
        for number, branch in enumerate(study.branches, start=1)
    ]
    for solution, name in zip(outside, study.outside, strict=True):
        joint, excess = solution.joint, abs(solution.value - solution.limit)
        lines.append(
            f"{title(len(lines) + 1, name, solution.positions)}: {joint} would be at "
            f"{joint_value(request.space, joint, solution.value)}, "
            f"{joint_value(request.space, joint, excess)} beyond its limit"
        )
    more = len(lines) - MOST_DETAILS
    return tuple(lines[:MOST_DETAILS]) + ((f"and {more} more",) if more > 0 else ())


def _in_collision(
    request: StageRequest, goal: LinkGoal, study: GoalStudy
) -> tuple[NearestState, str]:
    """The collision of the nearest branch, and the shortest move that frees the goal."""
    branch = study.branches[0]
    pose = request.kinematics.link_pose(request.space.whole(branch.positions), goal.link)
    nearest = NearestPose(branch.positions, pose, *branch.residual)
    state = replace(
        nearest_state(request, goal, nearest),
        shows="goal in collision",
        touches=touch_records(branch.touches),
    )
    pair = branch.touches[0]
    otherwise = (
        padding_advice(pair.distance, request.options.padding)
        if pair.distance >= 0
        else "where the contact is intended, plan inside `allow_collisions` with the pair "
        f"[{pair.first}, {pair.second}]"
    )
    found = nearest_free_shift(
        goal,
        lambda moved: (
            request.kinematics.analyse(
                request.space, moved, request.start, request.options.seed
            ).solutions
        ),
        request.is_free,
    )
    if found is None:
        farthest = length_text(SHIFTS[-1])
        return (
            state,
            f"no position within {farthest} along a world axis is free: move the goal farther; "
            f"{otherwise}",
        )
    shift, positions = found
    free = FreeShift(tuple(shift.tolist()), request.joints(positions))
    axis = int(np.argmax(np.abs(shift)))
    way = np.ceil(1000 * abs(shift[axis])) / 1000
    sign = "+" if shift[axis] > 0 else "-"
    return (
        replace(state, nearest_free=free),
        f"moved {length_text(way)} along {sign}{'xyz'[axis]} of the world the goal is free;"
        f" {otherwise}",
    )
