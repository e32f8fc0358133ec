"""Searches a path with OMPL, with the harness's edge checks and a counted budget."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.search.ompl_problem import OmplProblem, make_problem
from harness.planning.search.planner_names import resolve_planner_id
from harness.planning.search.planner_parameters import parameter_names, set_parameters
from harness.planning.search.roadmap import find_in_roadmap

DEFAULTS: Mapping[str, float] = {"range": 1.5, "find_approximate_solutions": 1}
"""Parameters of the planners that have them: a tree's longest edge [rad], by default a fifth of the
space's extent in OMPL, and approximate solutions, which give BITstar's remaining distance."""

IMPROVING_SHARE = 0.2
"""Part of the budget in which planners that improve their path (RRTstar, PRMstar, BITstar ...) do
so; the rest is for hard problems, and for a finer search should the path not hold. At the default
budget BITstar improves for 0.6 s; 9 s would go into half of it."""

STALLED = 100_000
"""Iterations of a planner without a state check after which it has stalled."""


class _Termination:
    """Stops a planner whose budget is used, whose path is improved enough, or that stalls."""

    def __init__(self, planner: ob.Planner, checker: MotionChecker, enough: int, end: int) -> None:
        self._best_cost: Callable[[], ob.Cost] | None = getattr(planner, "bestCost", None)
        self._checker = checker
        self._enough = enough
        self._end = end
        self._seen = self._idle = 0

    def __call__(self) -> bool:
        checks = self._checker.checks
        self._idle = self._idle + 1 if checks == self._seen else 0
        self._seen = checks
        if checks >= self._end or self._idle >= STALLED:
            return True
        if checks < self._enough or self._best_cost is None:
            return False
        return math.isfinite(self._best_cost().value())

    def release(self) -> None:
        """Drop the planner, which may hold this condition (AORRTC does): an uncollectable cycle."""
        self._best_cost = None


def search_ompl(
    planner_id: str,
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    *,
    resolution: float,
    max_state_checks: int,
    seed: int,
    parameters: Mapping[str, float],
) -> tuple[FloatArray | None, int, int, float]:
    """Search as `search` says; returns waypoints or None, checks, vertices, gap.

    The same arguments give the same path to the bit: OMPL's generator is seeded before anything
    that draws from it is made, and the budget is counted in state checks.

    Args:
        planner_id: A name that `resolve_planner_id` knows.
        checker: The checker of states and edges.
        start: The start positions of the group, free of collisions.
        goals: Group positions, each free.
        resolution: The resolution of the edge checks [rad].
        max_state_checks: Budget of this search.
        seed: The seed of OMPL's random numbers.
        parameters: The parameters of the planner, by OMPL's names: `range`, `goal_bias` ...

    Raises:
        ValueError: A planner or a parameter is unknown; says which there are.
    """
    kind = resolve_planner_id(planner_id)
    if any(np.array_equal(start, goal) for goal in goals):
        return np.array([start, start]), 0, 1, 0.0  # planners that sample an ellipsoid need two
    _seed_ompl(seed)
    before = checker.checks
    enough, end = before + int(IMPROVING_SHARE * max_state_checks), before + max_state_checks
    problem = make_problem(checker, start, goals, resolution, end)
    planner = getattr(og, kind)(problem.information)
    known = parameter_names(type(planner))
    defaults = {name: value for name, value in DEFAULTS.items() if name in known}
    set_parameters(planner, kind, {**defaults, **parameters})
    planner.setProblemDefinition(problem.definition)
    planner.setup()
    if isinstance(planner, og.PRM):
        improving = enough if kind == "PRMstar" else before
        ends = [tuple(map(float, positions)) for positions in (start, *goals)]
        way, gap = find_in_roadmap(planner, ends, lambda: checker.checks, improving, end)
        return way, checker.checks - before, planner.milestoneCount(), gap
    ending = _Termination(planner, checker, enough, end)
    planner.solve(ob.PlannerTerminationCondition(ending))
    ending.release()
    used = checker.checks - before
    vertices, gap = _reached(planner, problem, checker.space.dof)
    if not problem.definition.hasExactSolution():
        nothing_reached = min(float(np.linalg.norm(goal - start)) for goal in goals)
        return None, used, vertices, gap or nothing_reached
    states = problem.definition.getSolutionPath().getStates()
    waypoints = np.array([[state[index] for index in range(checker.space.dof)] for state in states])
    return waypoints, used, vertices, 0.0


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
