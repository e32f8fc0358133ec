"""Who plans: this project, with and without compiled code, and OMPL as written in Python."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

import time
from dataclasses import dataclass

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

from harness.planning.collision.compiled import When, use_compiled
from harness.planning.search.path_search import Effort, verified_paths
from harness.planning.search.shortening import shorten
from harness.planning.verification.verify import FINAL_RESOLUTION, verified_resolution
from harness.ports.motion_planning import PlanningOptions
from tests.benchmarks.planning.problems import EveryPair, Problem

SPACING = 1 / 32
"""Joint-space distance between the states that the naive planner checks [rad]."""

RANGE = 1.5  # [rad]
PATIENCE = 20.0
"""Time after which the naive planner gives up [s]; what it did not solve counts with it."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """The result of a contender.

    Attributes:
        scene: Time of the process to take the problem's things and pairs up, the robot known [s].
        plan: From there until a first path [s].
        total: From there until the path was shortened and, if the contender does so, verified [s].
        checks: States checked while planning.
        waypoints: Shape (N, dof), or None when nothing was found.
    """

    scene: float
    plan: float
    total: float
    checks: int
    waypoints: np.ndarray | None

    @property
    def length(self) -> float:
        """Joint-space length [rad]."""
        assert self.waypoints is not None
        return float(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1).sum())


def ours(problem: Problem, when: When, seed: int = 1) -> Outcome:
    """Plan, verify and shorten as `move_to` does."""
    use_compiled(when)
    problem.forget()
    before = time.process_time()
    checker, effort = problem.checker(), Effort()
    checker.edge_free(problem.start, problem.start, SPACING)  # lays out what is checked
    begin = time.process_time()
    scene = begin - before
    options = PlanningOptions(seed=seed, max_state_checks=2_000_000)
    planned, fine = None, verified_resolution(checker.padding)
    for found in verified_paths(checker, problem.start, [problem.goal], options, effort):
        planned = planned or time.process_time()
        for resolution in (FINAL_RESOLUTION, fine):
            short = shorten(found.waypoints, checker, resolution, found.seed)
            if checker.path_free(short, fine):
                done = time.process_time()
                return Outcome(scene, planned - begin, done - begin, effort.checks, short)
    spent = time.process_time() - begin
    return Outcome(scene, spent, spent, effort.checks, None)


def naive(problem: Problem, seed: int = 1) -> Outcome:
    """OMPL's RRTConnect and `simplifySolution` with a validity checker in Python."""
    ou.noOutputHandler()
    ou.RNG.setSeed(seed)
    problem.forget()
    before = time.process_time()
    checker, space = EveryPair(problem.scene, problem.space, problem.route.padding), problem.space
    begin = time.process_time()
    scene = begin - before
    states = ob.RealVectorStateSpace(space.dof)
    bounds = ob.RealVectorBounds(space.dof)
    for joint in range(space.dof):
        bounds.setLow(joint, float(space.lower[joint]))
        bounds.setHigh(joint, float(space.upper[joint]))
    states.setBounds(bounds)
    setup = og.SimpleSetup(states)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(
        lambda state: checker.free(np.array([state[joint] for joint in range(space.dof)]))
    )
    information.setStateValidityCheckingResolution(SPACING / states.getMaximumExtent())
    setup.setStartAndGoalStates(_state(states, problem.start), _state(states, problem.goal))
    planner = og.RRTConnect(information)
    planner.setRange(RANGE)
    setup.setPlanner(planner)
    end = begin + PATIENCE
    setup.solve(ob.PlannerTerminationCondition(lambda: time.process_time() > end))
    planned = time.process_time()
    checks = checker.checks
    if not setup.haveExactSolutionPath():
        return Outcome(scene, PATIENCE, PATIENCE, checks, None)
    setup.simplifySolution(PATIENCE)
    done = time.process_time()
    path = setup.getSolutionPath().getStates()
    waypoints = np.array([[state[joint] for joint in range(space.dof)] for state in path])
    return Outcome(scene, planned - begin, done - begin, checks, waypoints)


def _state(space: ob.RealVectorStateSpace, positions: np.ndarray) -> ob.State:
    state = space.allocState()
    for joint, value in enumerate(positions):
        state[joint] = float(value)
    return state


def is_free(problem: Problem, waypoints: np.ndarray) -> bool:
    """Whether a path keeps its margins at `FINAL_RESOLUTION`, by Coal alone.

    States are taken evenly from the start on, whatever the waypoints: others than those that the
    planner checked edge by edge.
    """
    checker = EveryPair(problem.scene, problem.space, problem.route.padding)
    lengths = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(lengths)])
    places = np.append(np.arange(0.0, knots[-1], FINAL_RESOLUTION), knots[-1])
    states = np.column_stack([np.interp(places, knots, column) for column in waypoints.T])
    return all(checker.free(state) for state in (*states, *waypoints))
