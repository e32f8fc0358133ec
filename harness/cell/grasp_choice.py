"""Which of several equally good ways is taken: the first that the arm can approach."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, resolve_goal
from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.ports import JointGoal, PlanningOptions
from harness.spec.goals import GoalFields

MOST_BRANCHES = 2
"""Free solutions of inverse kinematics before the approach from which it is tried."""


def first_that_goes(
    ways: Sequence[tuple[TcpGoal, TcpGoal]],
    group: str,
    cell: Cell,
    *,
    padding: float | None = None,
    may_end: Callable[[FloatArray], bool] | None = None,
) -> int:
    """Index of the first way whose straight approach the arm can follow; 0 when it can none.

    Args:
        ways: Where each approach begins, and where it ends.
        group: The planning group.
        cell: The robot and its surroundings now.
        padding: Of the straight approach [m]; by default the step's.
        may_end: Whether it may end at these positions of the whole robot; by default at any.
    """
    if len(ways) < 2:
        return 0
    cell.sync_scene()
    options = replace(cell.current.options, path_only=True)
    if padding is not None:
        options = replace(options, padding=padding)
    for index, (before, at) in enumerate(ways):
        ends = _ends(before, at, group, cell, options)
        if any(may_end is None or may_end(state) for state in ends):
            return index
    return 0


def _ends(
    before: TcpGoal, at: TcpGoal, group: str, cell: Cell, options: PlanningOptions
) -> Iterator[FloatArray]:
    """The whole robot at the end of each straight approach that it can follow."""
    goal = resolve_goal(GoalFields(**at.keys), group, cell)
    for state in _free_states(before, group, cell)[:MOST_BRANCHES]:
        try:
            plan = cell.planner.plan_linear(group, state, goal, options)
        except PlanningFailed:
            continue
        yield _with_arm(plan.trajectory.positions[-1], state, group, cell)


def _free_states(goal: TcpGoal, group: str, cell: Cell) -> list[FloatArray]:
    """The whole robot at a goal, free of collisions, nearest first."""
    wanted = resolve_goal(GoalFields(**goal.keys), group, cell)
    if isinstance(wanted, JointGoal):
        raise TypeError("a way leads to a pose or a position")
    start, options = cell.planning_start(), cell.current.options
    solutions = cell.kinematics.solve(group, wanted, start, options.seed)
    states = (_with_arm(positions, start, group, cell) for positions in solutions)
    return [state for state in states if not cell.scene.touches(state, options.padding)]


def _with_arm(positions: FloatArray, state: FloatArray, group: str, cell: Cell) -> FloatArray:
    whole = np.array(state)
    whole[list(cell.description.group_indices(group))] = positions
    return cell.description.with_mimics(whole)
