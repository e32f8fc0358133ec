"""The planners that a scenario may select, and their names."""

from __future__ import annotations

from collections.abc import Mapping

from harness.core.registry import registry
from harness.core.suggestion import did_you_mean
from harness.ports.path_planning import PathPlanner

DEFAULT_PLANNER = "auto"
FAST_PLANNER = "BalancedConnect"
PATIENT_PLANNER = "RRTConnect"

_CLASSES: Mapping[str, str] = {
    "auto": "auto",
    FAST_PLANNER: FAST_PLANNER,
    "RRTConnect": "RRTConnect",
    "RRT": "RRT",
    "RRTstar": "RRTstar",
    "InformedRRTstar": "InformedRRTstar",
    "SORRTstar": "SORRTstar",
    "KPIECE": "KPIECE1",
    "BKPIECE": "BKPIECE1",
    "LBKPIECE": "LBKPIECE1",
    "FMT": "FMT",
    "BFMT": "BFMT",
    "AORRTC": "AORRTC",
    "PRM": "PRM",
    "PRMstar": "PRMstar",
    "BITstar": "BITstar",
}
"""Planner name -> class of the OMPL wheel; the first two are built in."""

_REASONS: Mapping[str, tuple[str, ...]] = {
    "the OMPL wheel does not have it": (
        *("LazyPRM", "LazyPRMstar", "EST", "BiEST", "ProjEST", "SBL", "TRRT", "BiTRRT", "LBTRRT"),
        *("STRIDE", "PDST", "SPARS", "SPARStwo", "AITstar", "EITstar"),
    ),
    "it plans on several threads; shortening is always on": ("AnytimePathShortening",),
    "it is a pipeline of MoveIt, not a planner of OMPL": ("CHOMP", "STOMP", "TrajOpt"),
    "Pilz's motions are steps: write `ptp`": ("PTP",),
    "Pilz's motions are steps: write `lin`": ("LIN",),
    "Pilz's motions are steps: write `circ`": ("CIRC",),
}
_REFUSED = {name: reason for reason, names in _REASONS.items() for name in names}


def planner_names() -> tuple[str, ...]:
    """Names that `planner_id` may have; MoveIt's endings and OMPL's prefix are accepted too."""
    return tuple(_CLASSES)


def resolve_planner_id(name: str) -> str:
    """The planner that a name means: OMPL's class, or a built-in one.

    `geometric::RRTConnect` (OMPL), `RRTConnectkConfigDefault` (MoveIt), `RRTConnect` and
    `rrtconnect` are one planner.

    Raises:
        ValueError: The planner is unknown or refused; says why and what to write instead.
    """
    bare = _bare(name)
    by_lower = {known.lower(): known for known in (*_CLASSES, *_REFUSED)}
    by_lower |= {cls.lower(): known for known, cls in _CLASSES.items()}
    known = by_lower.get(bare.lower())
    usual = ", ".join(_CLASSES)
    if known is None:
        raise ValueError(f"unknown planner '{name}'; {did_you_mean(bare, _CLASSES, 'planners')}")
    if known in _REFUSED:
        raise ValueError(f"planner '{name}' is refused: {_REFUSED[known]}; planners: {usual}")
    return _CLASSES[known]


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


def _bare(name: str) -> str:
    bare = name.strip().removeprefix("geometric::").removesuffix("kConfigDefault")
    return bare.removesuffix("kConfig")
