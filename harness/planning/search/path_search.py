"""Searches paths with the requested pipeline and a budget of state checks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.core.registry import registry
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.search.find_pipeline import find_pipeline
from harness.planning.search.third_party import find_third_party_path
from harness.planning.verification.verify import FINAL_RESOLUTION, VERIFIED_RESOLUTION
from harness.ports.motion_planning import DEFAULT_PIPELINE, PlanningOptions
from harness.ports.path_planning import PathPlanner, PathRequest, PathResult

SEARCHES = 6  # of an attempt, from other seeds, while no path becomes a verified motion


@dataclass(frozen=True, eq=False)
class Search(PathResult):
    """The result of a planner; of a pipeline other than `ompl`, its name begins the planner's.

    Attributes:
        checks: The number of state checks.
        seed: The seed of the search, and of what is made of the path.
    """

    checks: int = 0
    seed: int = 0


def search(
    options: PlanningOptions,
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    *,
    max_state_checks: int,
    seed: int,
) -> Search:
    """Search a path from the start to any of the goals.

    The same arguments give the same path to the bit.

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
        is_edge_free=lambda first, second: checker.edge_free(first, second, VERIFIED_RESOLUTION),
        state_checks=lambda: checker.checks - before,
        max_state_checks=max_state_checks,
        resolution=FINAL_RESOLUTION,
        seed=seed,
        parameters=options.parameters,
    )
    if registry(PathPlanner.plugin_kind).is_own(pipeline):
        found = planner().find_path(request)
    else:
        found = find_third_party_path(planner, request)
    prefix = "" if pipeline == DEFAULT_PIPELINE else pipeline
    parts = (prefix, found.planner_id or request.planner_id)
    name = "/".join(part for part in parts if part)
    return Search(found.waypoints, found.vertices, found.gap, name, checker.checks - before, seed)


@dataclass(eq=False)
class Effort:
    """The cost of the searches of one planning call.

    Attributes:
        checks: The state checks of all searches.
        gaps: The remaining distances of the searches that failed, where they are known [rad].
    """

    checks: int = 0
    gaps: list[float] = field(default_factory=list[float])
    attempts: int = 0


def verified_paths(
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    options: PlanningOptions,
    effort: Effort,
) -> Iterator[tuple[Search, FloatArray]]:
    """Searches with their unshortened paths, from other seeds, until budget and attempts end.

    Raises:
        ValueError: A pipeline, a planner or a parameter is unknown.
        PlanningFailed: A third-party pipeline goes wrong.
    """
    for attempt in range(options.attempts):
        left, effort.attempts = options.max_state_checks, attempt + 1
        for number in range(SEARCHES):
            sequence = np.random.SeedSequence([options.seed % 2**63, attempt, number])
            seed = int(sequence.generate_state(1)[0])
            result = search(options, checker, start, goals, max_state_checks=left, seed=seed)
            effort.checks += result.checks
            left -= result.checks
            if result.waypoints is None:
                effort.gaps += [] if result.gap is None else [result.gap]
                break
            yield result, result.waypoints
            if left <= 0:
                break
