"""Searches paths that hold when they are checked finely: coarse first, then finer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.search.search import Search, search
from harness.planning.verification.verify import FINAL_RESOLUTION, VERIFIED_RESOLUTION
from harness.ports.motion_planning import PlanningOptions

PLANNING_RESOLUTIONS = (1 / 32, 1 / 64, 1 / 128, *(VERIFIED_RESOLUTION,) * 3)
"""Joint-space distance between checked states while searching [rad]; finer when a path fails, then
from other seeds."""


@dataclass(eq=False)
class Effort:
    """The cost of the searches of one planning call.

    Attributes:
        checks: The state checks of all searches.
        gaps: The remaining distances of the searches that failed, where they are known [rad].
        refused: The path of the last search, if it is not free at `FINAL_RESOLUTION`.
        planner_id: The planner of the last search.
        is_used_up: Whether a budget was used up.
    """

    checks: int = 0
    gaps: list[float] = field(default_factory=list[float])
    refused: FloatArray | None = None
    planner_id: str = ""
    is_used_up: bool = False


@dataclass(frozen=True, eq=False)
class FoundPath:
    """A path that is free at `FINAL_RESOLUTION`, and how it was found.

    Attributes:
        result: The result of the planner.
        waypoints: The waypoints, not shortened, shape (N, dof).
        attempt: The number of the attempt, from 0.
        resolution: The resolution of the search [rad].
        seed: The seed of that search, and of what is made of the path.
    """

    result: Search
    waypoints: FloatArray
    attempt: int
    resolution: float
    seed: int


def verified_paths(
    checker: MotionChecker,
    start: FloatArray,
    goals: Sequence[FloatArray],
    options: PlanningOptions,
    effort: Effort,
) -> Iterator[FoundPath]:
    """Paths, each searched more finely than the one before, until budget and attempts end.

    Raises:
        ValueError: A pipeline, a planner or a parameter is unknown.
        PlanningFailed: A third-party pipeline goes wrong.
    """
    for attempt in range(options.attempts):
        left = options.max_state_checks
        for level, resolution in enumerate(PLANNING_RESOLUTIONS):
            seed = _derived_seed(options.seed, attempt, level)
            result = search(
                options,
                checker,
                start,
                goals,
                resolution=resolution,
                max_state_checks=left,
                seed=seed,
            )
            effort.checks += result.checks
            effort.planner_id = result.planner_id
            left -= result.checks
            effort.is_used_up = left <= 0
            effort.refused = None
            if result.waypoints is None:
                effort.gaps += [] if result.gap is None else [result.gap]
                break
            if checker.path_free(result.waypoints, FINAL_RESOLUTION):
                yield FoundPath(result, result.waypoints, attempt, resolution, seed)
            else:
                effort.refused = result.waypoints
            if left <= 0:
                break


def _derived_seed(seed: int, attempt: int, level: int) -> int:
    return int(np.random.SeedSequence([seed % 2**63, attempt, level]).generate_state(1)[0])
