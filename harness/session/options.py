"""Planning options of a step: its own words, then the scenario's, then the defaults."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from harness.cell.program import step_seed
from harness.cell.scope import Problems
from harness.language.files.source import Loc
from harness.language.planning import Planning
from harness.ports.motion_planning import DEFAULT_PIPELINE, PlanningOptions

CheckPlanner = Callable[[str, str, Mapping[str, float]], str]
"""Normalises the name of a pipeline's planner; ValueError, with what there is, for it or its
parameters."""

DEFAULT_SCALING = 0.3  # of the joint limits: the course's default plan request
DEFAULT_PADDING = 0.002  # [m]
DEFAULT_STATE_CHECKS = 2_000_000  # of one search, as long as tens of seconds


def merged_options(
    scenario: Planning,
    step: Planning | None,
    seed: int,
    path: str,
    checks_per_second: int,
    planner_name: Callable[[str, str], str],
) -> PlanningOptions:
    """Options with every number known.

    Args:
        step: The step's, which wins key by key.
        path: Place of the step in the expanded file.
        checks_per_second: State checks that a second of `planning_time` buys.
        planner_name: Normalises a pipeline's `planner_id`; empty is the pipeline's default.
    """
    stated = scenario if step is None else _merged(scenario, step)
    pipeline = stated.pipeline or DEFAULT_PIPELINE
    checks = stated.max_state_checks
    if checks is None:
        seconds = stated.planning_time
        checks = DEFAULT_STATE_CHECKS if seconds is None else int(seconds * checks_per_second)
    root_seed = seed if stated.seed is None else stated.seed
    return PlanningOptions(
        pipeline=pipeline,
        planner_id=planner_name(pipeline, stated.planner_id or ""),
        max_state_checks=max(1, checks),
        attempts=stated.planning_attempts or 1,
        velocity_scaling=stated.max_velocity_scaling_factor or DEFAULT_SCALING,
        acceleration_scaling=stated.max_acceleration_scaling_factor or DEFAULT_SCALING,
        padding=DEFAULT_PADDING if stated.padding is None else stated.padding,
        seed=step_seed(root_seed, path),
        root_seed=root_seed,
        parameters=stated.parameters or {},
        max_jerk=stated.max_jerk or float("inf"),
    )


def _merged(scenario: Planning, step: Planning) -> Planning:
    """A step's planning, and the scenario's for what it does not state."""
    own = step.model_dump(exclude_none=True)
    if "planning_time" in own or "max_state_checks" in own:
        own = {"planning_time": None, "max_state_checks": None, **own}
    return _inherited(scenario, step).model_copy(update=own)


def _inherited(scenario: Planning, step: Planning) -> Planning:
    """The scenario's planning for a step: a step's own pipeline has its own planners."""
    if step.pipeline is None or step.pipeline == (scenario.pipeline or DEFAULT_PIPELINE):
        return scenario
    return scenario.model_copy(update={"planner_id": None, "parameters": None})


def check_planning(
    planning: Planning,
    loc: Loc,
    problems: Problems,
    check_planner: CheckPlanner,
    scenario: Planning | None = None,
) -> None:
    """Report a planner that there is not, what it does not take, two budgets.

    Args:
        scenario: What a step's goes before.
    """
    inherited = _inherited(scenario or Planning(), planning)
    pipeline = planning.pipeline or inherited.pipeline or DEFAULT_PIPELINE
    planner = planning.planner_id or inherited.planner_id or ""
    own, planner_place = planning.parameters or {}, (*loc, "planner_id")
    try:
        check_planner(pipeline, planner, {})
    except ValueError as error:
        if planning.planner_id is not None:
            problems.add(planner_place, str(error), needs=())
    else:
        checked = {name: ((*loc, "parameters", name), own[name]) for name in own}
        if planning.parameters is None and planning.planner_id is not None:
            theirs = inherited.parameters or {}
            checked = {name: (planner_place, theirs[name]) for name in theirs}
        for name, (place, value) in checked.items():
            try:
                check_planner(pipeline, planner, {name: value})
            except ValueError as error:
                problems.add(place, str(error), needs=())
    if planning.planning_time is not None and planning.max_state_checks is not None:
        problems.add(
            (*loc, "planning_time"),
            "both `planning_time` and `max_state_checks` are given",
            needs=(),
        )
