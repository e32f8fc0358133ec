"""The planner that scenarios call, next to its own search and to OMPL on the same checker.

MOTION_BENCH_MAKER names a folder with that data set, SEED draws other problems, EACH sets their
number in each family.
"""

# pyright: reportAttributeAccessIssue=false

import os
import secrets
import statistics
import time
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou
import pytest

from harness.core.errors import PlanningFailed
from harness.planning.efforts import InverseDynamics
from harness.planning.goals.goal_study import broken_limits
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.motion_planner import VerifiedPlanner
from harness.planning.search.path_search import Effort, verified_paths
from harness.planning.search.shortening import shorten
from harness.planning.verification.verify import VERIFIED_RESOLUTION
from harness.plugins.ompl_planners.sampling import make_problem
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion
from harness.ports.path_planning import PathRequest
from harness.robot.description import RobotDescription
from tests.benchmarks.planning.contenders import PATIENCE, SPACING
from tests.benchmarks.planning.motion_bench_maker import FOLDER, motion_bench_maker
from tests.benchmarks.planning.problems import DEFAULT, Problem

pytestmark = pytest.mark.benchmark

SEED = int(os.environ.get("SEED") or secrets.randbelow(1_000_000))
EACH = int(os.environ.get("EACH") or 3)
OMPL_SEEDS = (1, 2, 3)
OPTIONS = PlanningOptions(seed=1, padding=DEFAULT.padding)

Outcome = tuple[float, bool]
"""Processor time from the loaded scene on [s], and whether there is a path or motion."""


def searched(problem: Problem) -> Outcome:
    """A verified and shortened path."""
    begin, checker = time.process_time(), problem.checker()
    ends = problem.start, [problem.goal]
    for found, path in verified_paths(checker, *ends, OPTIONS, Effort()):
        short = shorten(path, checker, VERIFIED_RESOLUTION, found.seed)
        if checker.path_free(short, VERIFIED_RESOLUTION):
            return time.process_time() - begin, True
    return time.process_time() - begin, False


def planned(problem: Problem) -> Outcome:
    """A verified motion with times, as `move_to` has it; the arm is loaded once, as the scene."""
    planner = VerifiedPlanner(problem.scene, _kinematics(problem.scene.description))
    start, motion = problem.space.whole(problem.start), FreeMotion(JointGoal(problem.goal))
    request, begin = MotionRequest(problem.arm.group, start, motion, OPTIONS), time.process_time()
    try:
        planner.plan(request)
    except PlanningFailed:
        return time.process_time() - begin, False
    return time.process_time() - begin, True


@cache
def _kinematics(description: RobotDescription) -> PinocchioKinematics:
    return PinocchioKinematics(description)


def best_of_ompl(problem: Problem) -> Outcome:
    """The shortest of three runs of OMPL's RRTConnect, each stopped after `PATIENCE`.

    Its path is free at `SPACING`, and neither verified, shortened nor timed.
    """
    runs = [_ompl(problem, seed) for seed in OMPL_SEEDS]
    return min((run for run in runs if run[1]), default=(PATIENCE, False))


def _ompl(problem: Problem, seed: int) -> Outcome:
    ou.noOutputHandler()
    ou.RNG.setSeed(seed)
    begin, checker = time.process_time(), problem.checker()
    request = PathRequest(
        planner_id="RRTConnect",
        space=problem.space,
        start=problem.start,
        goals=(problem.goal,),
        is_state_free=checker.state_free,
        is_edge_free=lambda first, second: checker.edge_free(first, second, SPACING),
        state_checks=lambda: 0,
        max_state_checks=1,
        resolution=SPACING,
        seed=seed,
        parameters={},
    )
    made = make_problem(request)
    planner = og.RRTConnect(made.information)
    planner.setProblemDefinition(made.definition)
    planner.setup()
    end = begin + PATIENCE
    planner.solve(ob.PlannerTerminationCondition(lambda: time.process_time() > end))
    return time.process_time() - begin, made.definition.hasExactSolution()


def can_be_held(problem: Problem) -> bool:
    """Whether the arm can stand still at both ends, and the goal is within its joint limits."""
    dynamics, ends = InverseDynamics.of(problem.space, ()), np.array([problem.start, problem.goal])
    is_outside = bool(broken_limits(problem.space, problem.goal))
    return not is_outside and (dynamics is None or dynamics.can_hold(ends))


CONTENDERS: dict[str, Callable[[Problem], Outcome]] = {
    "search": searched,
    "scenario": planned,
    "OMPL, best of three": best_of_ompl,
}


def test_what_scenarios_call_and_others_on_the_same_checker(print_row):
    """Of problems whose ends the arm can hold within its limits; ratios are those of medians."""
    heading = f"what a scenario calls, ms of processor time; SEED={SEED}"
    if not FOLDER:
        print_row(heading, "limited: MOTION_BENCH_MAKER names no folder with that data set")
        return
    drawn = [*motion_bench_maker(DEFAULT, EACH, SEED)]
    for run in CONTENDERS.values():  # loads everything before it is timed
        _timed(drawn[0], run)
    print_row(heading, "arm", "who", "problems", "solved", "median", "95 %", "of the search's")
    for arm in dict.fromkeys(problem.arm for problem in drawn):
        some = [problem for problem in drawn if problem.arm is arm]
        held = [problem for problem in some if can_be_held(problem)]
        found = {name: [_timed(each, run) for each in held] for name, run in CONTENDERS.items()}
        for name, outcomes in found.items():
            ratio = _median(outcomes) / _median(found["search"])
            solved = f"{sum(solved for _, solved in outcomes)}"
            worst = 1000 * np.percentile([seconds for seconds, _ in outcomes], 95)
            figures = (f"{1000 * _median(outcomes):.1f}", f"{worst:.0f}", f"{ratio:.2f}x")
            print_row(heading, arm.name, name, f"{len(held)} of {len(some)}", solved, *figures)


def _timed(problem: Problem, run: Callable[[Problem], Outcome]) -> Outcome:
    problem.forget()
    problem.checker().edge_free(problem.start, problem.start, SPACING)  # loads the scene
    return run(problem)


def _median(outcomes: Sequence[Outcome]) -> float:
    return statistics.median(seconds for seconds, _ in outcomes)
