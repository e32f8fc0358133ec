"""Finds a planning pipeline by its name, without importing a planner."""

from __future__ import annotations

from collections.abc import Mapping

from harness.core.registry import registry
from harness.ports.motion_planning import DEFAULT_PIPELINE
from harness.ports.path_planning import PathPlanner


def find_pipeline(name: str) -> type[PathPlanner]:
    """The class of a planning pipeline.

    Raises:
        ValueError: There is none; says which there are.
    """
    try:
        return registry(PathPlanner.plugin_kind).find(name)
    except LookupError as error:
        raise ValueError(error.args[0]) from None


def check_planner(pipeline: str, planner_id: str, parameters: Mapping[str, float]) -> str:
    """Normalise the name of a pipeline's planner, and check that it accepts the parameters.

    Raises:
        ValueError: There is no such pipeline, planner or parameter; says which there are.
    """
    return find_pipeline(pipeline).check(planner_id, parameters)


def planner_names() -> tuple[str, ...]:
    """Every planner that can be compared: those of `ompl`, then each other pipeline's."""
    others = [
        f"{pipeline}/{each}" if each else pipeline
        for pipeline, planner in registry(PathPlanner.plugin_kind).items()
        if pipeline != DEFAULT_PIPELINE
        for each in planner.planner_ids or ("",)
    ]
    return (*find_pipeline(DEFAULT_PIPELINE).planner_ids, *others)
