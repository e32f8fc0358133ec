"""Selects the planners that are compared."""

from __future__ import annotations

from dataclasses import replace

from harness.core.registry import registry
from harness.planning.search.find_pipeline import check_planner
from harness.ports.motion_planning import DEFAULT_PIPELINE, PlanningOptions
from harness.ports.path_planning import PathPlanner


def with_planner(options: PlanningOptions, name: str) -> PlanningOptions:
    """Options with another planner: a planner of `ompl`, `PIPELINE`, or `PIPELINE/PLANNER`.

    Raises:
        ValueError: There is no such planner; says which there are.
    """
    first, _, rest = name.partition("/")
    is_pipeline = first in registry(PathPlanner.plugin_kind)
    pipeline, planner = (first, rest) if is_pipeline else (DEFAULT_PIPELINE, name)
    parameters = options.parameters if pipeline == options.pipeline else {}
    planner_id = check_planner(pipeline, planner, {})
    return replace(options, pipeline=pipeline, planner_id=planner_id, parameters=parameters)
