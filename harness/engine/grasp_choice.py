"""Which of several equally good grasps is taken: the first that the arm can approach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.engine.cell import Cell
from harness.engine.goals import TcpGoal, resolve_goal
from harness.ports import JointGoal

MOST_BRANCHES = 2
"""Free solutions of inverse kinematics before the approach from which it is tried."""


def first_that_goes(ways: Sequence[tuple[TcpGoal, TcpGoal]], group: str, cell: Cell) -> int:
    """Index of the first way whose straight approach the arm can follow; 0 when it can none.

    Args:
        ways: Where each approach begins, and where it ends.
        group: The planning group.
        cell: The robot and its surroundings now.
    """
    if len(ways) < 2:
        return 0
    cell.sync_scene()
    goes = (index for index, (before, at) in enumerate(ways) if _goes(before, at, group, cell))
    return next(goes, 0)


def _goes(before: TcpGoal, at: TcpGoal, group: str, cell: Cell) -> bool:
    goal = resolve_goal(at.lin(group), group, cell)
    options = replace(cell.current.options, path_only=True)
    for state in _free_states(before, group, cell)[:MOST_BRANCHES]:
        try:
            cell.planner.plan_linear(group, state, goal, options)
        except PlanningFailed:
            continue
        return True
    return False


def _free_states(goal: TcpGoal, group: str, cell: Cell) -> list[FloatArray]:
    """The whole robot at a goal, free of collisions, nearest first."""
    wanted = resolve_goal(goal.move_to(group), group, cell)
    if isinstance(wanted, JointGoal):
        raise TypeError("a grasp is a pose")
    start, options = cell.planning_start(), cell.current.options
    indices = list(cell.description.group_indices(group))
    states: list[FloatArray] = []
    for positions in cell.kinematics.solve(group, wanted, start, options.seed):
        state = np.array(start)
        state[indices] = positions
        state = cell.description.with_mimics(state)
        if not cell.scene.touches(state, options.padding):
            states.append(state)
    return states
