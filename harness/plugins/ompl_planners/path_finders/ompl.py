"""OMPL's planners, which the planning pipeline `ompl` offers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from harness.ports.path_planning import PathPlanner, PathRequest, PathResult


class OmplPlanners(PathPlanner):
    """The planners of OMPL, by the names of their classes."""

    plugin_kind: ClassVar[str] = "path_finder"
    name: ClassVar[str] = "ompl"

    @classmethod
    def check(cls, planner_id: str, parameters: Mapping[str, float]) -> str:
        """Give the parameters to a planner that plans nothing."""
        if parameters:
            from harness.plugins.ompl_planners.parameters import check_parameters

            check_parameters(planner_id, parameters)
        return planner_id

    def find_path(self, request: PathRequest) -> PathResult:
        """Search with one planner."""
        from harness.plugins.ompl_planners.sampling import search_ompl

        return search_ompl(request)
