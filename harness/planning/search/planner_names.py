"""The planners that a scenario may select, and their names."""

from __future__ import annotations

from collections.abc import Mapping

from harness.core.suggestion import did_you_mean

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
    if parameters:
        for each in (FAST_PLANNER, PATIENT_PLANNER) if kind == DEFAULT_PLANNER else (kind,):
            if each == FAST_PLANNER:
                from harness.planning.search.balanced_connect import step_length

                step_length(kind, parameters)
            else:
                from harness.planning.search.planner_parameters import check_parameters

                check_parameters(each, parameters)
    return kind


def _bare(name: str) -> str:
    bare = name.strip().removeprefix("geometric::").removesuffix("kConfigDefault")
    return bare.removesuffix("kConfig")
