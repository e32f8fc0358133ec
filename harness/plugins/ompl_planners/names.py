"""Names of OMPL's planners, and why MoveIt's others are refused."""

from __future__ import annotations

from collections.abc import Mapping

from harness.core.suggestion import did_you_mean
from harness.planning.search.planner_names import planner_names

CLASSES: Mapping[str, str] = {
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
"""Planner name -> class of the OMPL wheel."""

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


def resolve_name(name: str) -> str:
    """The class of OMPL that a name means.

    `geometric::RRTConnect` (OMPL), `RRTConnectkConfigDefault` (MoveIt), `RRTConnect` and
    `rrtconnect` are one planner.

    Raises:
        ValueError: The planner is unknown or refused; says why and what to write instead.
    """
    bare = name.strip().removeprefix("geometric::").removesuffix("kConfigDefault")
    bare = bare.removesuffix("kConfig")
    by_lower = {known.lower(): known for known in (*CLASSES, *_REFUSED)}
    by_lower |= {cls.lower(): known for known, cls in CLASSES.items()}
    known = by_lower.get(bare.lower())
    if known is None:
        hint = did_you_mean(bare, planner_names(), "planners")
        raise ValueError(f"unknown planner '{name}'; {hint}")
    if known in _REFUSED:
        usual = ", ".join(planner_names())
        raise ValueError(f"planner '{name}' is refused: {_REFUSED[known]}; planners: {usual}")
    return CLASSES[known]
