"""A hole in an object, into which a peg may go."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Hole:
    """A straight hole; its frame has its origin in the middle of the opening and z out of it.

    Attributes:
        pose: T_object_hole (xyz, quat wxyz).
        size: Full width along x and y [m]; of a round hole its diameter, twice.
        depth: How deep it is [m].
        is_round: Whether it is round.
    """

    pose: tuple[float, ...]
    size: tuple[float, float]
    depth: float
    is_round: bool
