"""What a run must record beyond the usual so that expectations can be judged from it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from harness.spec.checks import AnyExpectation, Clearance, Placed, TcpPose

CLEARANCE_CUTOFF = 0.15
"""Of `Signals.clearances` when nothing asks for more [m]."""
CLEARANCE_ROOM = 0.05
"""How much further than the largest distance asked for is recorded, to see margins [m]."""


@dataclass(frozen=True)
class Observations:
    """What to record.

    Attributes:
        frames: Names of frames whose poses are needed: links, but objects and `world` too, which
            are recorded anyway; sorted.
        clearance_cutoff: Distances up to here must be exact [m].
    """

    frames: tuple[str, ...]
    clearance_cutoff: float


def observations(expectations: Iterable[AnyExpectation]) -> Observations:
    """Frames and distances that expectations speak of."""
    frames: set[str] = set()
    cutoff = CLEARANCE_CUTOFF
    for spec in expectations:
        for model in (spec, getattr(spec, "predicate", None), getattr(spec, "until", None)):
            match model:
                case TcpPose(link=link, pose=pose):
                    frames |= {pose.frame} | ({link} if link is not None else set())
                case Placed(pose=pose) if pose is not None:
                    frames.add(pose.frame)
                case Clearance(at_least=at_least):
                    cutoff = max(cutoff, at_least + CLEARANCE_ROOM)
                case _:
                    pass
    return Observations(tuple(sorted(frames - {"world"})), cutoff)
