"""Searches a free path with the requested planning pipeline and a budget of state checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.search.find_pipeline import find_pipeline, is_built_in
from harness.planning.search.third_party import find_third_party_path
from harness.ports.motion_planning import DEFAULT_PIPELINE, PlanningOptions
from harness.ports.path_planning import PathRequest


@dataclass(frozen=True, eq=False)
class Search:
    """The result of a planner.

    Attributes:
        waypoints: The path, shape (N, dof), or None when there is none.
        checks: The number of state checks.
        vertices: The number of vertices of its trees or graph.
        gap: The remaining joint-space distance between its trees or to the goal [rad]; 0 if solved,
            None if unknown.
        planner_id: The planner's name; of a pipeline other than `ompl`, the pipeline's name first.
    """

    waypoints: FloatArray | None
    checks: int
    vertices: int
    gap: float | None
    planner_id: str


def search(
    options: PlanningOptions,
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    *,
    resolution: float,
    max_state_checks: int,
    seed: int,
) -> Search:
    """Search a path from the start to any of the goals.

    The same arguments give the same path to the bit.

    Args:
        options: The pipeline, the planner and its parameters.
        checker: The checker of states and edges.
        start: The start positions of the group, free of collisions.
        goals: Group positions, each free.
        resolution: The resolution of the edge checks [rad].
        max_state_checks: Budget of this search.
        seed: The seed of samples.

    Raises:
        ValueError: A pipeline, a planner or a parameter is unknown; says which there are.
        PlanningFailed: A third-party pipeline goes wrong.
    """
    pipeline = options.pipeline
    planner = find_pipeline(pipeline)
    before = checker.checks
    request = PathRequest(
        planner_id=planner.check(options.planner_id, options.parameters),
        space=checker.space,
        start=start,
        goals=tuple(goals),
        is_state_free=checker.state_free,
        is_edge_free=lambda first, second: checker.edge_free(first, second, resolution),
        state_checks=lambda: checker.checks - before,
        max_state_checks=max_state_checks,
        resolution=resolution,
        seed=seed,
        parameters=options.parameters,
    )
    if is_built_in(pipeline):
        found = planner().find_path(request)
    else:
        found = find_third_party_path(planner, request)
    prefix = "" if pipeline == DEFAULT_PIPELINE else pipeline
    parts = (prefix, found.planner_id or request.planner_id)
    name = "/".join(part for part in parts if part)
    return Search(found.waypoints, checker.checks - before, found.vertices, found.gap, name)
