"""Carrying a cup upright, next to OMPL that rejects or projects states, on the same checker."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

import os
import secrets
import statistics
import time

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou
import pytest

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.goals.goal_choice import choose_goals
from harness.planning.task import make_task
from harness.plugins.motions.held_constraints import PathBands
from harness.ports.motion_planning import PlanningOptions
from tests.benchmarks.planning.cups import KINDS, CupProblem, cup_problems

pytestmark = pytest.mark.benchmark

SEED = int(os.environ.get("SEED") or secrets.randbelow(1_000_000))
EACH = int(os.environ.get("EACH") or 2)
"""Problems of each arm and kind."""
PATIENCE = 3.0
"""Processor time after which OMPL is stopped [s]."""

TOLERANCE, INSIDE = 1e-3, 0.05
"""Of OMPL's projection [rad], and how far inside the bounds it ends, as a share of a band."""

OPTIONS = PlanningOptions(padding=0.002, seed=1)


def ours(problem: CupProblem) -> tuple[float, bool]:
    """Processor time of a planned, timed and verified motion [s], and whether there is one."""
    problem.forget()
    problem.checker(OPTIONS).state_free(problem.space().part(problem.state))  # loads the scene
    begin = time.process_time()
    try:
        problem.ports.planner.plan(problem.request(OPTIONS))
    except PlanningFailed:
        return time.process_time() - begin, False
    return time.process_time() - begin, True


def rejecting(problem: CupProblem) -> tuple[float, bool]:
    """OMPL's RRTConnect that rejects states which violate the constraints."""
    return _by_ompl(problem, is_projecting=False)


def projecting(problem: CupProblem) -> tuple[float, bool]:
    """OMPL's RRTConnect in its `ProjectedStateSpace`, with derivatives of the constraints."""
    return _by_ompl(problem, is_projecting=True)


class _Bands(ob.Constraint):
    """How far beyond its bounds each value is: zero inside them, as OMPL takes inequalities.

    States are projected well inside the bounds, as this program's own projection does it.
    """

    def __init__(self, held: PathBands) -> None:
        super().__init__(held.space.dof, len(held.lower), TOLERANCE)
        margin = INSIDE * np.where(np.isfinite(held.upper), held.upper - held.lower, 0.0)
        self._held, self._bounds = held, (held.lower + margin, held.upper - margin)

    def function(self, x: FloatArray, out: FloatArray) -> None:
        values = self._held._values_at(np.array(x))  # noqa: SLF001
        out[:] = values - np.clip(values, *self._bounds)

    def jacobian(self, x: FloatArray, out: FloatArray) -> None:
        values = self._held._values_at(np.array(x))  # noqa: SLF001
        is_off = values != np.clip(values, *self._bounds)
        out[:] = self._held._rates() * is_off[:, None]  # noqa: SLF001


def _by_ompl(problem: CupProblem, *, is_projecting: bool) -> tuple[float, bool]:
    """The processor time to a first path, which is neither shortened nor timed [s], if any."""
    ou.noOutputHandler()
    ou.RNG.setSeed(1)
    problem.forget()
    task = make_task(
        problem.ports.scene,
        problem.ports.kinematics.robot,
        problem.arm.group,
        problem.state,
        OPTIONS,
        problem.constraints,
    )
    held, dof = task.held, task.space.dof
    assert isinstance(held, PathBands)
    task.checker.state_free(task.start)
    begin = time.process_time()
    goals = choose_goals(problem.ports.kinematics, task, problem.state, problem.goal).positions
    bounds = ob.RealVectorBounds(dof)
    for joint in range(dof):
        bounds.setLow(joint, float(task.space.lower[joint]))
        bounds.setHigh(joint, float(task.space.upper[joint]))
    space = ob.RealVectorStateSpace(dof)
    space.setBounds(bounds)
    if is_projecting:
        constraint, ambient = _Bands(held), space
        space = ob.ProjectedStateSpace(ambient, constraint)
        information = ob.ConstrainedSpaceInformation(space)
    else:
        information = ob.SpaceInformation(space)
    end = begin + PATIENCE

    def is_valid(state: ob.State) -> bool:
        if time.process_time() > end:
            return False
        positions = np.array([space.getValueAddressAtIndex(state, joint) for joint in range(dof)])
        return held.hold(positions) and task.checker.state_free(positions)

    information.setStateValidityChecker(is_valid)
    information.setStateValidityCheckingResolution(1 / 32 / space.getMaximumExtent())
    information.setup()
    definition = ob.ProblemDefinition(information)
    definition.addStartState(_state(space, task.start))
    goal = ob.GoalStates(information)
    for positions in goals:
        goal.addState(_state(space, positions))
    definition.setGoal(goal)
    planner = og.RRTConnect(information)
    planner.setProblemDefinition(definition)
    planner.setup()
    planner.solve(ob.PlannerTerminationCondition(lambda: time.process_time() > end))
    return time.process_time() - begin, definition.hasExactSolution()


def _state(space: ob.StateSpace, positions: FloatArray) -> ob.State:
    state = space.allocState()
    if isinstance(state, ob.ConstrainedStateSpaceStateType):
        state.copy(positions)
        return state
    for joint, value in enumerate(positions):
        state[joint] = float(value)
    return state


def test_a_cup_is_carried_upright(print_row):
    """Ratios compare medians on the same problems; the paths of OMPL are not timed or verified."""
    contenders = {
        "armharness": ours,
        "OMPL, rejecting": rejecting,
        "OMPL, projecting": projecting,
    }
    found = {name: {kind: [] for kind in KINDS} for name in contenders}
    for problem in cup_problems(EACH, SEED):
        for name, contender in contenders.items():
            found[name][problem.kind].append(contender(problem))
    heading = f"carrying a cup upright, ms of processor time and solved; SEED={SEED}"
    print_row(heading, "kind", *contenders)
    for kind in KINDS:
        print_row(heading, kind, *(_cell(found[name][kind]) for name in contenders))
    every = {name: [one for kind in KINDS for one in found[name][kind]] for name in contenders}
    print_row(heading, "all", *map(_cell, every.values()))


def _cell(outcomes: list[tuple[float, bool]]) -> str:
    seconds = statistics.median(each for each, _ in outcomes)
    return f"{1000 * seconds:.0f}, {sum(solved for _, solved in outcomes)} of {len(outcomes)}"
