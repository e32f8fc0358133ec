"""Asks OMPL for a path between positions of a group, with our edge checks and a counted budget."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

from harness.core.types import FloatArray
from harness.planning.checker import MotionChecker
from harness.planning.planner_names import resolve_planner_id
from harness.planning.robot_model import GroupSpace

DEFAULT_RANGE = 1.5
"""Longest edge that a tree grows at once [rad]; OMPL takes a fifth of the space's extent."""

_BEYOND = np.pi  # [rad] how far a continuous joint may leave the range of start and goals


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
        checker: Of states and edges.
        start: Group positions, free.
        goals: Group positions, each free.
        resolution: Of the edge checks [rad].
        max_state_checks: Budget of this search.
        seed: Of OMPL's random numbers.
        parameters: Of the planner, by OMPL's names: `range`, `goal_bias` ...

    Raises:
        ValueError: A planner or a parameter is unknown; says which there are.
    """
    kind = resolve_planner_id(planner_id)
    space = checker.space
    _seed_ompl(seed)
    before = checker.checks
    end = before + max_state_checks
    information, definition = _problem(space, checker, start, goals, resolution, end)
    planner = getattr(og, kind)(information)
    _set_parameters(planner, {"range": DEFAULT_RANGE}, strict=False)
    _set_parameters(planner, parameters, strict=True)
    planner.setProblemDefinition(definition)
    planner.setup()
    planner.solve(ob.PlannerTerminationCondition(lambda: checker.checks >= end))
    used = checker.checks - before
    data = ob.PlannerData(information)
    planner.getPlannerData(data)
    vertices = int(data.numVertices())
    if not definition.hasExactSolution():
        return None, used, vertices, _gap(data, definition, space)
    path = definition.getSolutionPath()
    states = path.getStates()
    waypoints = np.array([[state[index] for index in range(space.dof)] for state in states])
    return waypoints, used, vertices, 0.0


def _seed_ompl(seed: int) -> None:
    """Seed every generator made from now on; OMPL logs about seeding twice: silence it."""
    ou.noOutputHandler()
    ou.RNG.setSeed(seed % (2**31 - 1) + 1)


def _problem(
    space: GroupSpace,
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    resolution: float,
    end: int,
) -> tuple[ob.SpaceInformation, ob.ProblemDefinition]:
    """OMPL's view of the problem; planners that draw whole batches find nothing free at the end."""
    ends = np.vstack([start, *goals])
    states = ob.RealVectorStateSpace(space.dof)
    bounds = ob.RealVectorBounds(space.dof)
    for index in range(space.dof):
        low, high = float(space.lower[index]), float(space.upper[index])
        bounds.setLow(index, low if np.isfinite(low) else float(ends[:, index].min()) - _BEYOND)
        bounds.setHigh(index, high if np.isfinite(high) else float(ends[:, index].max()) + _BEYOND)
    states.setBounds(bounds)
    information = ob.SpaceInformation(states)
    dof = space.dof
    information.setStateValidityChecker(
        lambda state: (
            checker.checks < end
            and checker.state_free(np.array([state[index] for index in range(dof)]))
        )
    )
    information.setMotionValidator(_EdgeValidator(information, checker, resolution, end))
    information.setup()
    definition = ob.ProblemDefinition(information)
    definition.addStartState(_state(states, start))
    goal = ob.GoalStates(information)
    for positions in goals:
        goal.addState(_state(states, positions))
    definition.setGoal(goal)
    return information, definition


def _state(space: ob.RealVectorStateSpace, positions: FloatArray) -> ob.State:
    state = space.allocState()
    for index, value in enumerate(positions):
        state[index] = float(value)
    return state


def _set_parameters(planner: ob.Planner, parameters: Mapping[str, float], *, strict: bool) -> None:
    """Call the planner's setters (`goal_bias` is `setGoalBias`); the wheel has no ParamSet."""
    for name, value in parameters.items():
        setter = getattr(planner, "set" + "".join(word.title() for word in name.split("_")), None)
        if setter is not None:
            whole = float(value).is_integer()
            for number in (float(value), int(value) if whole else value, bool(value)):
                try:
                    setter(number)
                    break
                except TypeError:
                    continue
            else:
                raise ValueError(f"planner parameter '{name}' cannot be {value}")
        elif strict:
            names = ", ".join(parameter_names(type(planner)))
            raise ValueError(
                f"planner {planner.getName()} has no parameter '{name}' (it has: {names})"
            )


def parameter_names(planner: type) -> tuple[str, ...]:
    """OMPL's names of a planner class's parameters, read from its setters."""
    camel = [name[3:] for name in dir(planner) if name.startswith("set")]
    not_parameters = {"Name", "ProblemDefinition", "ProjectionEvaluator", "up"}
    return tuple(
        re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
        for name in camel
        if name not in not_parameters
    )


def _gap(data: ob.PlannerData, definition: ob.ProblemDefinition, space: GroupSpace) -> float:
    """How near the searched part came to the goal, or the two trees to each other [rad]."""
    count = data.numVertices()
    points = np.array(
        [[data.getVertex(v).getState()[i] for i in range(space.dof)] for v in range(count)]
    ).reshape(count, space.dof)
    tags = np.array([data.getVertex(v).getTag() for v in range(count)])
    if len(set(tags.tolist())) == 2:
        first, second = (points[tags == tag] for tag in sorted(set(tags.tolist())))
        return float(np.sqrt(min(((first - q) ** 2).sum(axis=1).min() for q in second)))
    return float(definition.getSolutionDifference())
