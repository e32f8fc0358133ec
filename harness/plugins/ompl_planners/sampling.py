"""Searches a path with OMPL, with the harness's edge checks and a counted budget."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

from harness.core.types import FloatArray
from harness.plugins.ompl_planners.parameters import parameter_names, set_parameters
from harness.plugins.ompl_planners.roadmap import find_in_roadmap
from harness.ports.kinematics import JointSpace
from harness.ports.path_planning import PathRequest, PathResult

DEFAULTS: Mapping[str, float] = {"range": 1.5, "find_approximate_solutions": 1}
"""Parameters of the planners that have them: a tree's longest edge [rad], by default a fifth of the
space's extent in OMPL, and approximate solutions, which give BITstar's remaining distance."""

IMPROVING_SHARE = 0.02
"""Part of the budget in which planners that improve their path (RRTstar, PRMstar, BITstar ...) do
so; the rest is for hard problems, and for a finer search should the path not hold. At the default
budget BITstar improves for 0.6 s; 9 s would go into a twentieth of it."""

STALLED = 100_000  # Iterations of a planner without a state check after which it has stalled
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
    nearest, farthest = ends.min(axis=0), ends.max(axis=0)
    low = np.where(np.isfinite(space.lower), space.lower, nearest - _BEYOND)
    high = np.where(np.isfinite(space.upper), space.upper, farthest + _BEYOND)
    bounds = ob.RealVectorBounds(space.dof)
    for index in range(space.dof):  # OMPL waits for another goal where one is outside
        bounds.setLow(index, float(min(low[index], nearest[index])))
        bounds.setHigh(index, float(max(high[index], farthest[index])))
    return bounds


def _state(space: ob.RealVectorStateSpace, positions: FloatArray) -> ob.State:
    state = space.allocState()
    for index, value in enumerate(positions):
        state[index] = float(value)
    return state


class _Termination:
    """Stops a planner whose budget is used, whose path is improved enough, or that stalls."""

    def __init__(self, planner: ob.Planner, request: PathRequest, enough: int) -> None:
        self._best_cost: Callable[[], ob.Cost] | None = getattr(planner, "bestCost", None)
        self._request = request
        self._enough = enough
        self._seen = self._idle = 0

    def __call__(self) -> bool:
        checks = self._request.state_checks()
        self._idle = self._idle + 1 if checks == self._seen else 0
        self._seen = checks
        if checks >= self._request.max_state_checks or self._idle >= STALLED:
            return True
        if checks < self._enough or self._best_cost is None:
            return False
        return math.isfinite(self._best_cost().value())

    def release(self) -> None:
        """Drop the planner, which may hold this condition (AORRTC does): an uncollectable cycle."""
        self._best_cost = None


def search_ompl(request: PathRequest) -> PathResult:
    """Search a path.

    The same request gives the same path to the bit: OMPL's generator is seeded before anything
    that draws from it is made, and the budget is counted in state checks.

    Raises:
        ValueError: A planner or a parameter is unknown; says which there are.
    """
    kind, start, goals = request.planner_id, request.start, request.goals
    if any(np.array_equal(start, goal) for goal in goals):  # samplers of an ellipsoid need two
        return PathResult(np.array([start, start]), 1, 0.0)
    _seed_ompl(request.seed)
    enough = int(IMPROVING_SHARE * request.max_state_checks)
    problem = make_problem(request)
    planner = getattr(og, kind)(problem.information)
    known = parameter_names(type(planner))
    defaults = {name: value for name, value in DEFAULTS.items() if name in known}
    set_parameters(planner, kind, {**defaults, **request.parameters})
    planner.setProblemDefinition(problem.definition)
    planner.setup()
    if isinstance(planner, og.PRM):
        improving = enough if kind == "PRMstar" else 0
        ends = [tuple(map(float, positions)) for positions in (start, *goals)]
        way, gap = find_in_roadmap(
            planner, ends, request.state_checks, improving, request.max_state_checks
        )
        return PathResult(way, planner.milestoneCount(), gap)
    ending = _Termination(planner, request, enough)
    planner.solve(ob.PlannerTerminationCondition(ending))
    ending.release()
    dof = request.space.dof
    vertices, gap = _reached(planner, problem, dof)
    if not problem.definition.hasExactSolution():
        nothing_reached = min(float(np.linalg.norm(goal - start)) for goal in goals)
        return PathResult(None, vertices, gap or nothing_reached)
    states = problem.definition.getSolutionPath().getStates()
    waypoints = np.array([[state[index] for index in range(dof)] for state in states])
    return PathResult(waypoints, vertices, 0.0)


def _seed_ompl(seed: int) -> None:
    """Seed every generator made from now on; OMPL logs about seeding twice: silence it."""
    ou.noOutputHandler()
    ou.RNG.setSeed(seed % (2**31 - 1) + 1)


def _reached(planner: ob.Planner, problem: OmplProblem, dof: int) -> tuple[int, float]:
    """Vertices, and the remaining distance to the goal, or between the two trees [rad].

    The distance is 0 when OMPL reports none. BITstar's graph is not read: OMPL 2.0 keeps all its
    states until the process ends (5 MB a plan); its samples are counted as vertices instead.
    """
    gap = max(0.0, float(problem.definition.getSolutionDifference()))
    if isinstance(planner, og.BITstar):
        return problem.free_states.count, gap
    data = ob.PlannerData(problem.information)
    planner.getPlannerData(data)
    count = int(data.numVertices())
    points = np.array(
        [[data.getVertex(v).getState()[i] for i in range(dof)] for v in range(count)]
    ).reshape(count, dof)
    tags = np.array([data.getVertex(v).getTag() for v in range(count)])
    if len(set(tags.tolist())) == 2:
        first, second = (points[tags == tag] for tag in sorted(set(tags.tolist())))
        gap = float(np.sqrt(min(((first - q) ** 2).sum(axis=1).min() for q in second)))
    return count, gap
