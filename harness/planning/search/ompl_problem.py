"""OMPL's view of a planning problem: our checks of states and edges, their number bounded."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ompl.base as ob

from harness.core.types import FloatArray
from harness.ports.kinematics import JointSpace
from harness.ports.path_planning import PathRequest

_BEYOND = np.pi  # [rad] how far a continuous joint may leave the range of start and goals


class FreeStates:
    """Says which states are free, and counts them; only the ends are when the budget has ended.

    So planners that draw whole batches terminate, and none lacks a start or a goal.
    """

    def __init__(self, request: PathRequest, ends: FloatArray) -> None:
        self.count = 0
        self._request = request
        self._ends = {tuple(positions) for positions in ends.tolist()}
        self._dof = request.space.dof

    def __call__(self, state: ob.State) -> bool:
        positions = tuple(state[index] for index in range(self._dof))
        if self._request.state_checks() < self._request.max_state_checks:
            free = self._request.is_state_free(np.array(positions))
        else:
            free = positions in self._ends
        self.count += free
        return free


class _EdgeValidator(ob.MotionValidator):
    def __init__(self, information: ob.SpaceInformation, request: PathRequest) -> None:
        super().__init__(information)
        self._request = request

    def checkMotion(self, first: ob.State, second: ob.State) -> bool:  # noqa: N802 (OMPL's name)
        """Whether the whole edge is free; none is when the budget has ended."""
        request = self._request
        if request.state_checks() >= request.max_state_checks:
            return False
        joints = range(request.space.dof)
        return request.is_edge_free(
            np.array([first[index] for index in joints]),
            np.array([second[index] for index in joints]),
        )


@dataclass(frozen=True, eq=False)
class OmplProblem:
    """What a planner is made of, what it solves, and the states it found free."""

    information: ob.SpaceInformation
    definition: ob.ProblemDefinition
    free_states: FreeStates


def make_problem(request: PathRequest) -> OmplProblem:
    """The problem of getting from the start to any of the goals."""
    space, start, goals = request.space, request.start, request.goals
    ends = np.vstack([start, *goals])
    states = ob.RealVectorStateSpace(space.dof)
    states.setBounds(_bounds(space, ends))
    information = ob.SpaceInformation(states)
    free_states = FreeStates(request, ends)
    information.setStateValidityChecker(free_states)
    information.setMotionValidator(_EdgeValidator(information, request))
    information.setup()
    definition = ob.ProblemDefinition(information)
    definition.addStartState(_state(states, start))
    goal = ob.GoalStates(information)
    for positions in goals:
        goal.addState(_state(states, positions))
    definition.setGoal(goal)
    return OmplProblem(information, definition, free_states)


def _bounds(space: JointSpace, ends: FloatArray) -> ob.RealVectorBounds:
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
