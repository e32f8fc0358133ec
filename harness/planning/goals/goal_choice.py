"""Chooses joint positions for several goals and for goal regions, which are sampled."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.collision.wording import counted_noun
from harness.planning.goals.goals import GoalCandidates, find_goals
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.task import PlanningTask
from harness.planning.verification.path_constraints import HeldConstraints
from harness.ports.goals import AnyGoal, Goal, PoseGoal
from harness.recording.explanation import Alternative, Alternatives, GoalRegion

SAMPLES = 24  # Number of poses sampled in a region in addition to its centre
ROOM = (0.005, 0.05)
"""Smallest tolerances of a goal region [m], [rad]; below them only the centre is solved."""

WIDE = 0.2  # Angle tolerance from which all poses of a region are equivalent to its centre [rad]
MOST_CANDIDATES = 16  # goals of one search: those of least effort


def choose_goals(
    kinematics: PinocchioKinematics,
    task: PlanningTask,
    start: FloatArray,
    goal: Goal | AnyGoal,
) -> GoalCandidates:
    """Find free joint positions that reach a goal, one of several goals, or a goal region.

    Args:
        task: The planning call with its options; the goal satisfies its path constraints.

    Raises:
        PlanningFailed: The errors of `find_goals`, or GOAL_VIOLATES_PATH_CONSTRAINTS.
    """

    def find(one: Goal) -> GoalCandidates:
        found = find_goals(kinematics, task.checker, start, one, task.options.seed)
        return found if task.held is None else _holding(found, task.held, task, one)

    if isinstance(goal, AnyGoal):
        every = goal.goals
        return _one_of(every, lambda one: choose_goals(kinematics, task, start, one), task)
    if not isinstance(goal, PoseGoal) or not has_room(goal):
        return find(goal)
    middle: GoalCandidates | PlanningFailed
    try:
        middle = find(goal)
    except PlanningFailed as failure:
        middle = failure
    if isinstance(middle, GoalCandidates) and max(_tolerances(goal)) < WIDE:
        return middle
    found: list[GoalCandidates] = [] if isinstance(middle, PlanningFailed) else [middle]
    for pose in poses_in(goal, task.options.seed):
        try:
            found.append(find(PoseGoal(goal.link, pose)))
        except PlanningFailed:
            continue
    if not found:
        if isinstance(middle, PlanningFailed):
            raise middle
        raise ValueError("the centre has a solution")
    explanation = found[0].explanation + Details.of(GoalRegion(len(found)))
    return _merged(found, task, explanation)


def has_room(goal: PoseGoal) -> bool:
    """Whether a pose goal is a region rather than a pose."""
    return goal.position_tolerance >= ROOM[0] or max(_tolerances(goal)) >= ROOM[1]


def poses_in(goal: PoseGoal, seed: int) -> list[SE3]:
    """Sample poses T_world_link uniformly inside a goal's tolerances, from a seed."""
    rng = np.random.default_rng(seed % 2**63)
    poses: list[SE3] = []
    for _ in range(SAMPLES):
        shift = rng.normal(size=3)
        shift *= 0.95 * goal.position_tolerance * rng.random() ** (1 / 3) / np.linalg.norm(shift)
        turn = pin.exp3(rng.uniform(-0.95, 0.95, 3) * np.minimum(_tolerances(goal), np.pi))
        poses.append(SE3(goal.pose.rotation @ turn, goal.pose.translation + shift))
    return poses


def _tolerances(goal: PoseGoal) -> tuple[float, float, float]:
    every = goal.orientation_tolerance
    return goal.axis_tolerances or (every, every, every)


def _holding(
    found: GoalCandidates, held: HeldConstraints, task: PlanningTask, goal: Goal
) -> GoalCandidates:
    """The candidates that satisfy the path constraints."""
    kept = held.solutions(found.positions, goal, task.checker, task.start, task.options.seed)
    if kept:
        return replace(found, positions=tuple(kept))
    broken = held.violation(found.positions[0])
    why = "" if broken is None else f": {broken.what}"
    raise PlanningFailed(
        "GOAL_VIOLATES_PATH_CONSTRAINTS",
        f"the goal has {counted_noun(found.positions, 'free solution')}, but none satisfies the "
        f"path constraints{why}",
        *found.explanation,
        *(() if broken is None else (broken.record,)),
    )


def _one_of(
    goals: Sequence[Goal], find: Callable[[Goal], GoalCandidates], task: PlanningTask
) -> GoalCandidates:
    """Collect the candidates of all goals, least effort first.

    Raises:
        PlanningFailed: No goal has candidates; the code is that of the most advanced failure.
    """
    found: list[GoalCandidates] = []
    failures: list[PlanningFailed] = []
    alternatives: list[Alternative] = []
    for goal in goals:
        try:
            candidates = find(goal)
        except PlanningFailed as failure:
            failures.append(failure)
            alternatives.append(Alternative(failure.code, failure.message))
            continue
        found.append(candidates)
        alternatives.append(Alternative("", ways=len(candidates.positions)))
    if found:
        return _merged(found, task, Details.of(Alternatives(tuple(alternatives))))
    worst = max(failures, key=lambda failure: failure.code != "NO_IK_SOLUTION")
    raise PlanningFailed(
        worst.code,
        f"none of {len(goals)} goals is feasible: "
        + "; ".join(f"{index + 1}: {each.message}" for index, each in enumerate(failures)),
        *worst.details,
        Alternatives(tuple(alternatives)),
    )


def _merged(
    found: Sequence[GoalCandidates], task: PlanningTask, explanation: Details
) -> GoalCandidates:
    space = task.space
    every = [positions for candidates in found for positions in candidates.positions]
    every.sort(key=lambda positions: round(space.effort(task.start, positions), 9))
    return GoalCandidates(tuple(every[:MOST_CANDIDATES]), explanation)
