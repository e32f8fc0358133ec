"""OMPL's view of a planning problem: our checks of states and edges, their number bounded."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ompl.base as ob

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker

_BEYOND = np.pi  # [rad] how far a continuous joint may leave the range of start and goals


class FreeStates:
    """Says which states are free, and counts them; only the ends are when the budget has ended.

    So planners that draw whole batches terminate, and none lacks a start or a goal.
    """

    def __init__(self, checker: MotionChecker, ends: FloatArray, end: int) -> None:
        self.count = 0
        self._checker = checker
        self._ends = {tuple(positions) for positions in ends.tolist()}
        self._end = end
        self._dof = checker.space.dof

    def __call__(self, state: ob.State) -> bool:
        positions = tuple(state[index] for index in range(self._dof))
        if self._checker.checks < self._end:
            free = self._checker.state_free(np.array(positions))
        else:
            free = positions in self._ends
        self.count += free
        return free


class _EdgeValidator(ob.MotionValidator):
    def __init__(
        self, information: ob.SpaceInformation, checker: MotionChecker, resolution: float, end: int
    ) -> None:
        super().__init__(information)
        self._checker = checker
        self._end = end
        self._resolution = resolution
        self._dof = checker.space.dof

    def checkMotion(self, first: ob.State, second: ob.State) -> bool:  # noqa: N802 (OMPL's name)
        """Whether the whole edge is free; none is when the budget has ended."""
        if self._checker.checks >= self._end:
            return False
        dof = self._dof
        return self._checker.edge_free(
            np.array([first[index] for index in range(dof)]),
            np.array([second[index] for index in range(dof)]),
            self._resolution,
        )


@dataclass(frozen=True, eq=False)
class OmplProblem:
    """What a planner is made of, what it solves, and the states it found free."""

    information: ob.SpaceInformation
    definition: ob.ProblemDefinition
    free_states: FreeStates


def make_problem(
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    resolution: float,
    end: int,
) -> OmplProblem:
    """The problem of getting from the start to any of the goals.

    Args:
        checker: The checker of states and edges.
        start: The start positions of the group, free of collisions.
        goals: Group positions, each free.
        resolution: The resolution of the edge checks [rad].
        end: The checker's count at which the budget ends.
    """
    ends = np.vstack([start, *goals])
    states = ob.RealVectorStateSpace(checker.space.dof)
    states.setBounds(_bounds(checker, ends))
    information = ob.SpaceInformation(states)
    free_states = FreeStates(checker, ends, end)
    information.setStateValidityChecker(free_states)
    information.setMotionValidator(_EdgeValidator(information, checker, resolution, end))
    information.setup()
    definition = ob.ProblemDefinition(information)
    definition.addStartState(_state(states, start))
    goal = ob.GoalStates(information)
    for positions in goals:
        goal.addState(_state(states, positions))
    definition.setGoal(goal)
    return OmplProblem(information, definition, free_states)


def _bounds(checker: MotionChecker, ends: FloatArray) -> ob.RealVectorBounds:
    space = checker.space
    bounds = ob.RealVectorBounds(space.dof)
    for index in range(space.dof):
        low, high = float(space.lower[index]), float(space.upper[index])
        bounds.setLow(index, low if np.isfinite(low) else float(ends[:, index].min()) - _BEYOND)
        bounds.setHigh(index, high if np.isfinite(high) else float(ends[:, index].max()) + _BEYOND)
    return bounds


def _state(space: ob.RealVectorStateSpace, positions: FloatArray) -> ob.State:
    state = space.allocState()
    for index, value in enumerate(positions):
        state[index] = float(value)
    return state
