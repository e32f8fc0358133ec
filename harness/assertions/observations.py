"""What a run must record beyond the usual so that expectations can be judged from it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from harness.spec.checks import (
    AnyExpectation,
    Clearance,
    Formula,
    Placed,
    TcpPath,
    TcpPose,
)
from harness.spec.formula import Node, constants_of, frames_of, signals_of
from harness.spec.formula_parser import parse_formula

CLEARANCE_CUTOFF = 0.15
"""Of `Signals.clearances` when nothing asks for more [m]."""
CLEARANCE_ROOM = 0.05
"""How much further than the largest distance asked for is recorded, to see margins [m]."""
LARGEST_CUTOFF = 2.0
"""However far a formula asks [m]."""


@dataclass(frozen=True)
class Observations:
    """What to record.

    Attributes:
        frames: Names of frames whose poses are needed: links, but objects and `world` too, which
            are recorded anyway; sorted.
        clearance_cutoff: Distances up to here must be exact [m].
        planned_clearances: Whether distances are needed with the arm at its commands, too.
    """

    frames: tuple[str, ...]
    clearance_cutoff: float
    planned_clearances: bool = False


def observations(expectations: Iterable[AnyExpectation]) -> Observations:
    """Frames and distances that expectations speak of."""
    frames: set[str] = set()
    cutoff, is_planned = CLEARANCE_CUTOFF, False
    for spec in expectations:
        for model in (spec, getattr(spec, "predicate", None), getattr(spec, "until", None)):
            match model:
                case TcpPose(link=link, pose=pose):
                    frames |= {pose.frame} | ({link} if link is not None else set())
                case Placed(pose=pose) if pose is not None:
                    frames.add(pose.frame)
                case Clearance():
                    cutoff = max(cutoff, (model.at_least or 0.0) + CLEARANCE_ROOM)
                    is_planned |= model.max_below_plan is not None
                case TcpPath():
                    frames |= {pose.frame for _, pose in model.corners()}
                case Formula(formula=text):
                    root = parse_formula(text)
                    frames |= {name for name in frames_of(root) if name != "tcp"}
                    cutoff = max(cutoff, _furthest(root))
                case _:
                    pass
    return Observations(tuple(sorted(frames - {"world"})), cutoff, is_planned)


def _furthest(root: Node) -> float:
    """A cutoff of distances beyond every length that a formula compares one with [m]."""
    if not any(node.name == "distance" for node in signals_of(root)):
        return 0.0
    lengths = [abs(each.value) for each in constants_of(root) if each.unit in ("", "m")]
    return min(max(lengths, default=0.0) + CLEARANCE_ROOM, LARGEST_CUTOFF)
