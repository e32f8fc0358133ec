"""Parameters of OMPL's planners by the names that OMPL and MoveIt give them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

import ompl.base as ob

_NAMES: Mapping[str, tuple[str, ...]] = {
    "AdmissibleCostToCome": ("use_admissible_heuristic",),
    "BatchSize": ("ordering_batch_size",),
    "ConsiderApproximateSolutions": ("find_approximate_solutions",),
    "DelayCC": ("delay_collision_checking",),
    "DelayRewiringUntilInitialSolution": ("delay_rewiring_to_first_solution",),
    "DropSamplesOnPrune": ("drop_unconnected_samples_on_prune",),
    "FailedExpansionCellScoreFactor": ("failed_expansion_score_factor",),
    "JustInTimeSampling": ("use_just_in_time_sampling",),
    "KNearest": ("use_k_nearest",),
    "NearestK": ("nearest_k", "use_k_nearest"),
    "NumSamplingAttempts": ("number_sampling_attempts",),
    "PruneThresholdFraction": ("prune_threshold_as_fractional_cost_change",),
    "Pruning": ("use_graph_pruning",),
    "StopOnSolnImprovement": ("stop_on_each_solution_improvement",),
    "StrictQueueOrdering": ("use_strict_queue_ordering",),
}
"""Setter -> parameter, where OMPL spells them apart (as printSettings prints them)."""

_RANGES: Mapping[str, tuple[int, int]] = {
    "max_nearest_neighbors": (1, 1_000),
    "num_samples": (1, 1_000_000),
    "samples_per_batch": (1, 1_000_000),
}
"""Counts with which a planner terminates; OMPL suggests these and does not check them."""

_NO_PARAMETERS = {
    "DefaultConnectionStrategy",
    "Name",
    "ProblemDefinition",
    "ProjectionEvaluator",
    "up",  # setup
}


def set_parameters(planner: ob.Planner, kind: str, parameters: Mapping[str, float]) -> None:
    """Give a planner its parameters through its setters; the wheel does not bind OMPL's ParamSet.

    Args:
        parameters: The parameters by OMPL's names: `range`, `goal_bias` ...; 0 and 1 are no and
            yes.

    Raises:
        ValueError: A parameter is unknown, or OMPL takes no such value; says which there are.
    """
    setters = _setters(type(planner))
    for name, value in parameters.items():
        if name not in setters:
            there = ", ".join(setters) or "none"
            raise ValueError(f"planner {kind} has no parameter '{name}' (it has: {there})")
        low, high = _RANGES.get(name, (-math.inf, math.inf))
        if not low <= value <= high:
            raise ValueError(f"planner parameter '{name}' cannot be {value:g}: {low} to {high}")
        try:
            _call(getattr(planner, setters[name]), value)
        except TypeError:
            raise ValueError(f"planner parameter '{name}' cannot be {value:g}") from None
        except RuntimeError as refusal:
            raise ValueError(f"planner {kind} refuses '{name}': {refusal}") from refusal


def check_parameters(kind: str, parameters: Mapping[str, float]) -> None:
    """Give parameters to a planner that plans nothing.

    Raises:
        ValueError: As `set_parameters`.
    """
    import ompl.geometric as og

    nowhere = ob.SpaceInformation(ob.RealVectorStateSpace(1))
    set_parameters(getattr(og, kind)(nowhere), kind, parameters)


def parameter_names(planner: type) -> tuple[str, ...]:
    """OMPL's names of a planner class's parameters."""
    return tuple(_setters(planner))


def _setters(planner: type) -> dict[str, str]:
    """Parameter -> name of its setter."""
    spelled = [name[3:] for name in dir(planner) if name.startswith("set")]
    return {
        name: "set" + setter
        for setter in spelled
        if setter not in _NO_PARAMETERS
        for name in _NAMES.get(setter, (_snake(setter),))
    }


def _snake(camel: str) -> str:
    """`UseKNearest` is use_k_nearest, `ExtendedFMT` extended_fmt."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", camel).lower()


def _call(setter: Callable[[float], None], value: float) -> None:
    """With the value as the type that the setter takes.

    Raises:
        TypeError: It takes none of them.
    """
    forms = [float(value)]
    forms += [int(value)] if float(value).is_integer() else []
    forms += [bool(value)] if value in (0, 1) else []
    for form in forms:
        try:
            setter(form)
        except TypeError:
            continue
        return
    raise TypeError
