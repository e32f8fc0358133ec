"""Searches a free path with the requested planner and a budget of state checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.search.planner_names import FAST_PLANNER, PATIENT_PLANNER, resolve_planner_id

FAST_SHARE = 0.5
"""Part of the budget that `auto` gives to the fast planner; the patient one gets the rest."""


@dataclass(frozen=True, eq=False)
class Search:
    """The result of a planner.

    Attributes:
        waypoints: The path, shape (N, dof), or None when the budget is used up.
        checks: The number of state checks.
        vertices: The number of vertices of its trees or graph.
        gap: The remaining joint-space distance between its trees or to the goal [rad]; 0 if solved.
        planner_id: The name of the planner.
    """

    waypoints: FloatArray | None
    checks: int
    vertices: int
    gap: float
    planner_id: str


def search(
    planner_id: str,
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    *,
    resolution: float,
    max_state_checks: int,
    seed: int,
    parameters: Mapping[str, float],
) -> Search:
    """Search a path from the start to any of the goals.

    The same arguments give the same path to the bit.

    Args:
        planner_id: A name that `resolve_planner_id` knows; `auto` is the fast planner, then the
            patient one.
        checker: The checker of states and edges.
        start: The start positions of the group, free of collisions.
        goals: Group positions, each free.
        resolution: The resolution of the edge checks [rad].
        max_state_checks: Budget of this search.
        seed: The seed of samples.
        parameters: The parameters of the planner, by OMPL's names: `range`, `goal_bias` ...

    Raises:
        ValueError: A planner or a parameter is unknown; says which there are.
    """
    name = resolve_planner_id(planner_id)
    if name == "auto":
        budget = max(1, int(FAST_SHARE * max_state_checks))
        first = _search_with(
            FAST_PLANNER, checker, start, goals, resolution, budget, seed, parameters
        )
        left = max_state_checks - first.checks
        if first.waypoints is not None or left <= 0:
            return first
        second = _search_with(
            PATIENT_PLANNER, checker, start, goals, resolution, left, seed, parameters
        )
        return Search(
            second.waypoints,
            first.checks + second.checks,
            first.vertices + second.vertices,
            min(first.gap, second.gap),
            second.planner_id,
        )
    return _search_with(name, checker, start, goals, resolution, max_state_checks, seed, parameters)


def _search_with(
    name: str,
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    resolution: float,
    max_state_checks: int,
    seed: int,
    parameters: Mapping[str, float],
) -> Search:
    if name == FAST_PLANNER:
        from harness.planning.search.balanced_connect import search_connect as run
    else:
        from harness.planning.search.ompl_planner import search_ompl as run
    found = run(
        name,
        checker,
        start,
        goals,
        resolution=resolution,
        max_state_checks=max_state_checks,
        seed=seed,
        parameters=parameters,
    )
    return Search(*found, name)
