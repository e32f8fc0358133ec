"""The planners that a scenario may select: two of the core, and those of a plug-in."""

from __future__ import annotations

from collections.abc import Mapping

from harness.core.registry import registry
from harness.ports.path_planning import PathPlanner

DEFAULT_PLANNER = "auto"
FAST_PLANNER = "BalancedConnect"
PATIENT_PLANNER = "RRTConnect"


def planner_names() -> tuple[str, ...]:
    """Names that `planner_id` may have; MoveIt's endings and OMPL's prefix are accepted too."""
    others = ompl_planners().planner_ids if registry("path_finder") else ()
    return (DEFAULT_PLANNER, FAST_PLANNER, *others)


def resolve_planner_id(name: str) -> str:
    """The planner that a name means, in whatever case: a built-in one, or OMPL's class.

    Raises:
        ValueError: The planner is unknown or refused; says why and what to write instead.
    """
    own = {each.lower(): each for each in (DEFAULT_PLANNER, FAST_PLANNER)}
    return own.get(name.strip().lower()) or ompl_planners().check(name, {})


def check_planner(name: str, parameters: Mapping[str, float]) -> str:
    """Resolve a planner name and check that the planner accepts the parameters.

    Raises:
        ValueError: The planner is unknown or refused, or does not take one; says what there is.
    """
    kind = resolve_planner_id(name)
    is_both = kind == DEFAULT_PLANNER and parameters
    for each in (FAST_PLANNER, PATIENT_PLANNER) if is_both else (kind,):
        if each == FAST_PLANNER and parameters:
            from harness.planning.search.balanced_connect import step_length

            step_length(kind, parameters)
        elif each not in (FAST_PLANNER, DEFAULT_PLANNER):
            ompl_planners().check(each, parameters)
    return kind


def ompl_planners() -> type[PathPlanner]:
    """The planners of OMPL, which are a plug-in.

    Raises:
        ValueError: There is none.
    """
    try:
        return registry("path_finder").find("ompl")
    except LookupError as error:
        raise ValueError(error.args[0]) from None
