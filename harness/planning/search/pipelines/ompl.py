"""The planning pipeline `ompl`: OMPL's planners, and the built-in fast planner."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

from harness.core.registry import registry
from harness.planning.search.planner_names import (
    DEFAULT_PLANNER,
    FAST_PLANNER,
    PATIENT_PLANNER,
    check_planner,
    ompl_planners,
    planner_names,
    resolve_planner_id,
)
from harness.ports.path_planning import PathPlanner, PathRequest, PathResult

FAST_SHARE = 0.8
"""Part of the budget that `auto` gives to the fast planner; the patient one gets the rest.

Of 2,000 searches in cages around a 7-axis arm, 4 took the fast planner more than half of the
default budget, none more than two thirds; the patient one failed in one of six with that half. Two
searches of the fast planner with other samples, each with a share, solved no more than one.
"""


class Ompl(PathPlanner):
    """Sampling-based planners: those of OMPL, and the built-in BalancedConnect."""

    name: ClassVar[str] = "ompl"
    planner_ids: ClassVar[tuple[str, ...]] = planner_names()

    @classmethod
    def check(cls, planner_id: str, parameters: Mapping[str, float]) -> str:
        """Accept the names of OMPL and MoveIt too; a planner's parameters are those of OMPL."""
        return check_planner(planner_id or DEFAULT_PLANNER, parameters)

    def find_path(self, request: PathRequest) -> PathResult:
        """Search with one planner; `auto` is the fast planner, then the patient one."""
        name = resolve_planner_id(request.planner_id)
        if not registry("path_finder"):
            name = FAST_PLANNER  # the core alone
        if name != DEFAULT_PLANNER:
            return _find_path_with(name, request)
        budget = max(1, int(FAST_SHARE * request.max_state_checks))
        first = _find_path_with(FAST_PLANNER, replace(request, max_state_checks=budget))
        used = request.state_checks()
        left = request.max_state_checks - used
        if first.waypoints is not None or left <= 0:
            return first
        rest = replace(
            request,
            max_state_checks=left,
            state_checks=lambda: request.state_checks() - used,
        )
        second = _find_path_with(PATIENT_PLANNER, rest)
        gaps = [each.gap for each in (first, second) if each.gap is not None]
        return replace(second, vertices=first.vertices + second.vertices, gap=min(gaps))


def _find_path_with(name: str, request: PathRequest) -> PathResult:
    request = replace(request, planner_id=name)
    if name == FAST_PLANNER:
        from harness.planning.search.balanced_connect import search_connect

        return replace(search_connect(request), planner_id=name)
    return replace(ompl_planners()().find_path(request), planner_id=name)
