"""Chooses, of several equally good approaches, the first that the arm can follow."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, resolve_goal
from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.language.goals import GoalFields
from harness.ports.goals import AnyGoal, JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion, LinearMotion
from harness.recording.explanation import ApproachFailure

MOST_BRANCHES = 3  # free IK solutions before an approach from which it is tried
REACH_CHECKS = 20_000  # state checks of the search for a motion to the begin of one approach


@dataclass(frozen=True)
class Approach:
    """A straight motion of the TCP to where something is grasped or put down.

    Attributes:
        number: The number of the grasp or turn, from 0; approaches of several lengths share it.
    """

    before: TcpGoal
    at: TcpGoal
    number: int

    @property
    def direction(self) -> tuple[float, float, float]:
        """Unit vector of the motion in the world."""
        way = np.subtract(self.at.target.xyz, self.before.target.xyz)
        x, y, z = (float(value) for value in way / np.linalg.norm(way))
        return x, y, z


@dataclass(frozen=True)
class GraspSearch:
    """How approaches are tried.

    Attributes:
        start: The whole robot before, description order.
        may_end: Whether it may end at these positions of the whole robot.
        then: Whether what follows can be carried out from there; preferred, not required.
    """

    group: str
    start: FloatArray
    options: PlanningOptions
    may_end: Callable[[FloatArray], bool] = lambda _: True
    then: Callable[[FloatArray], bool] = lambda _: True


@dataclass(frozen=True, eq=False)
class ChosenApproach:
    """The approach that is taken.

    Attributes:
        begin: Joint positions from which the arm can follow it, in group order, by joint; None
            where no such positions are known.
    """

    approach: Approach
    begin: Mapping[str, float] | None = None

    @property
    def reach_keys(self) -> dict[str, Any]:
        """The goal of the motion to where it begins, as a motion step has it."""
        return self.approach.before.keys if self.begin is None else {"joints": self.begin}


@dataclass(frozen=True, eq=False)
class _Line:
    """A straight approach that the arm can follow: the whole robot at its start and its end."""

    begin: FloatArray
    end: FloatArray


def choose_approach(
    approaches: Sequence[Approach], search: GraspSearch, cell: Cell
) -> ChosenApproach:
    """The first approach that the arm can follow, if possible one after which the step can go on.

    Raises:
        PlanningFailed: No approach has ends that the arm can reach free of collisions; the
            explanation is that of the end which comes nearest to being possible.
    """
    cell.sync_scene()
    followed: ChosenApproach | None = None
    for approach in approaches:
        lines = list(_lines(approach, search, cell))
        onward = [line for line in lines if search.then(line.end)]
        if not onward and (not lines or (followed is not None and followed.begin is not None)):
            continue
        chosen = ChosenApproach(approach, _reached(onward or lines, search, cell))
        if onward and chosen.begin is not None:
            return chosen
        if followed is None or (followed.begin is None and chosen.begin is not None):
            followed = chosen
    return followed or ChosenApproach(_most_promising(approaches, search, cell))


def _reached(lines: Sequence[_Line], search: GraspSearch, cell: Cell) -> dict[str, float] | None:
    """The start of the approach that needs the least motion; None where the arm reaches none."""
    options = cell.current.options
    budget = min(options.max_state_checks, REACH_CHECKS)
    options = replace(options, is_explained=False, max_state_checks=budget)
    arm = list(cell.description.group_indices(search.group))
    goal = AnyGoal(tuple(JointGoal(line.begin[arm]) for line in lines))
    try:
        plan = cell.planner.plan(
            MotionRequest(search.group, search.start, FreeMotion(goal), options)
        )
    except PlanningFailed:
        return None
    names = cell.description.groups[search.group].joint_names
    return dict(zip(names, map(float, plan.trajectory.positions[-1]), strict=True))


def _most_promising(approaches: Sequence[Approach], search: GraspSearch, cell: Cell) -> Approach:
    """The approach of which most is possible.

    Raises:
        PlanningFailed: One of its ends is not.
    """
    progress = [_progress(approach, search, cell) for approach in approaches]
    best = approaches[int(np.argmax(progress))]
    for goal, options in ((best.at, search.options), (best.before, cell.current.options)):
        joint_goal = resolve_goal(GoalFields(**goal.keys), search.group, cell)
        try:
            cell.planner.check_goal(
                MotionRequest(search.group, search.start, FreeMotion(joint_goal), options)
            )
        except PlanningFailed as failure:
            direction = best.direction
            failure.details += Details.of(ApproachFailure(goal is best.before, direction))
            raise
    return best


def _progress(approach: Approach, search: GraspSearch, cell: Cell) -> float:
    """How many of these hold: the end is reachable, it is free; then the same of the beginning.

    Of two ends in collision the one with less penetration counts more.
    """
    count = 0
    paddings = search.options.padding, cell.current.options.padding
    for goal, padding in zip((approach.at, approach.before), paddings, strict=True):
        solutions = _solutions(goal, search, cell)
        if not solutions:
            return count
        depths = [_depth(state, padding, cell) for state in solutions]
        if min(depths) > 0:
            return count + 1 - min(min(depths), 0.5)
        count += 2
    return count


def _depth(state: FloatArray, padding: float, cell: Cell) -> float:
    """How much nearer than allowed the nearest pair is [m]; 0 where the state is free."""
    touches = cell.scene.touches(state, padding)
    return max((touch.required - touch.distance for touch in touches), default=0.0)


def _lines(approach: Approach, search: GraspSearch, cell: Cell) -> Iterator[_Line]:
    """The straight approaches that the arm can follow, from the nearest postures before them."""
    goal = resolve_goal(GoalFields(**approach.at.keys), search.group, cell)
    states = _solutions(approach.before, search, cell)
    padding = cell.current.options.padding
    free = [state for state in states if not cell.scene.touches(state, padding)]
    options = replace(search.options, path_only=True, is_explained=False)
    for state in free[:MOST_BRANCHES]:
        try:
            plan = cell.planner.plan(
                MotionRequest(search.group, state, LinearMotion(goal), options)
            )
        except PlanningFailed:
            continue
        end = with_arm(plan.trajectory.positions[-1], state, search.group, cell)
        if search.may_end(end):
            yield _Line(state, end)


def _solutions(goal: TcpGoal, search: GraspSearch, cell: Cell) -> list[FloatArray]:
    """The whole robot at a goal, nearest to the start first."""
    joint_goal = resolve_goal(GoalFields(**goal.keys), search.group, cell)
    if isinstance(joint_goal, JointGoal):
        raise TypeError("an approach leads to a pose or a position")
    solutions = cell.kinematics.solve(search.group, joint_goal, search.start, search.options.seed)
    return [with_arm(positions, search.start, search.group, cell) for positions in solutions]


def with_arm(positions: FloatArray, state: FloatArray, group: str, cell: Cell) -> FloatArray:
    """The whole robot in a state, with the group at its own positions; mimic joints follow."""
    whole = np.array(state)
    whole[list(cell.description.group_indices(group))] = positions
    return cell.description.with_mimics(whole)
