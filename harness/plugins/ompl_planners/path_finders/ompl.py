"""OMPL's planners, which the planning pipeline `ompl` offers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from harness.plugins.ompl_planners.names import CLASSES, resolve_name
from harness.ports.path_planning import PathPlanner, PathRequest, PathResult


class OmplPlanners(PathPlanner):
    """The planners of OMPL, by the names of their classes."""

    plugin_kind: ClassVar[str] = "path_finder"
    name: ClassVar[str] = "ompl"
    planner_ids: ClassVar[tuple[str, ...]] = tuple(CLASSES)

    @classmethod
    def check(cls, planner_id: str, parameters: Mapping[str, float]) -> str:
        """Accept MoveIt's names too; give the parameters to a planner that plans nothing."""
        name = resolve_name(planner_id)
        if parameters:
            from harness.plugins.ompl_planners.parameters import check_parameters

            check_parameters(name, parameters)
        return name

    def find_path(self, request: PathRequest) -> PathResult:
        """Search with one planner."""
        from harness.plugins.ompl_planners.sampling import search_ompl

        return search_ompl(request)
