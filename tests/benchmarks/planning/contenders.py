"""Who plans: this project, and OMPL as written in Python."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

from harness.core.types import FloatArray
from harness.planning.search.path_search import Effort, verified_paths
from harness.planning.search.shortening import shorten
from harness.planning.verification.verify import VERIFIED_RESOLUTION
from harness.ports.motion_planning import PlanningOptions
from tests.benchmarks.planning.problems import Problem, free_by_broad_phase, free_by_pairs

SPACING = 1 / 32
"""Joint-space distance between the states that the other planners check [rad]."""

RANGE = 1.5  # [rad]
PATIENCE = 5.0
"""Processor time after which the other planners are stopped, to plan and to shorten [s]."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """The result of a contender.

    Attributes:
        scene: Processor time to load the problem's objects and pairs, the robot known [s].
        plan: From there until a first path; `PATIENCE` where there is none [s].
        total: From there until the path was shortened and, if the contender does so, verified [s];
            at most `PATIENCE`, at which the others are stopped.
        waypoints: Shape (N, dof), or None when nothing was found.
    """

    scene: float
    plan: float
    total: float
    waypoints: FloatArray | None

    @property
    def length(self) -> float:
        """Joint-space length [rad]."""
        assert self.waypoints is not None
        return float(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1).sum())


def ours(problem: Problem, seed: int = 1) -> Outcome:
    """Plan, verify and shorten as `move_to` does."""
    problem.forget()
    before = time.process_time()
    checker, effort = problem.checker(), Effort()
    checker.edge_free(problem.start, problem.start, SPACING)  # lays out what is checked
    begin = time.process_time()
    scene, planned = begin - before, None
    options = PlanningOptions(seed=seed)
    for found, path in verified_paths(checker, problem.start, [problem.goal], options, effort):
        planned = planned or time.process_time()
        short = shorten(path, checker, VERIFIED_RESOLUTION, found.seed)
        if checker.path_free(short, VERIFIED_RESOLUTION):
            return Outcome(scene, planned - begin, time.process_time() - begin, short)
    spent = time.process_time() - begin
    return Outcome(scene, spent, spent, None)


def naive(problem: Problem) -> Outcome:
    """Check the states of OMPL as it is usually written in Python."""
    return _ompl(problem, free_by_pairs)


def broad_phase(problem: Problem) -> Outcome:
    """Check the states of OMPL in Python with Pinocchio's broad phase."""
    return _ompl(problem, free_by_broad_phase)


def _ompl(
    problem: Problem, checked: Callable[[Problem], Callable[[FloatArray], bool]], seed: int = 1
) -> Outcome:
    """OMPL's RRTConnect and `simplifySolution` with a validity checker in Python."""
    ou.noOutputHandler()
    ou.RNG.setSeed(seed)
    problem.forget()
    before = time.process_time()
    is_free, space = checked(problem), problem.space
    begin = time.process_time()
    scene, end = begin - before, begin + PATIENCE
    states = ob.RealVectorStateSpace(space.dof)
    bounds = ob.RealVectorBounds(space.dof)
    for joint in range(space.dof):
        bounds.setLow(joint, float(space.lower[joint]))
        bounds.setHigh(joint, float(space.upper[joint]))
    states.setBounds(bounds)
    setup = og.SimpleSetup(states)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(
        lambda state: is_free(np.array([state[joint] for joint in range(space.dof)]))
    )
    information.setStateValidityCheckingResolution(SPACING / states.getMaximumExtent())
    setup.setStartAndGoalStates(_state(states, problem.start), _state(states, problem.goal))
    planner = og.RRTConnect(information)
    planner.setRange(RANGE)
    setup.setPlanner(planner)
    patience = ob.PlannerTerminationCondition(lambda: time.process_time() > end)
    setup.solve(patience)
    planned = time.process_time()
    if not setup.haveExactSolutionPath():
        return Outcome(scene, PATIENCE, PATIENCE, None)
    setup.simplifySolution(patience)
    total = min(time.process_time() - begin, PATIENCE)
    path = setup.getSolutionPath().getStates()
    waypoints = np.array([[state[joint] for joint in range(space.dof)] for state in path])
    return Outcome(scene, planned - begin, total, waypoints)


def _state(space: ob.RealVectorStateSpace, positions: FloatArray) -> ob.State:
    state = space.allocState()
    for joint, value in enumerate(positions):
        state[joint] = float(value)
    return state
