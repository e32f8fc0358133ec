"""What planning knows of path constraints, which a kind of motion evaluates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.ports.goals import Goal
from harness.recording.motion_failures import ConstraintFailure

FindFrame = Callable[[str], tuple[str, SE3]]
"""The link that carries a link or an attached object, and T_link_frame."""


@dataclass(frozen=True)
class Violation:
    """The constraint that a state breaks most.

    Attributes:
        what: The violation in words: `end_effector_link is turned 0.20 rad about y, 0.10 rad are
            allowed`.
        excess: Beyond its tolerance [rad or m].
    """

    what: str
    excess: float
    record: ConstraintFailure


class HeldConstraints(Protocol):
    """Path constraints of one planning call, made by the kind of motion `constrained`."""

    def first_violation(self, states: FloatArray) -> tuple[int, Violation] | None:
        """The first of states (N, dof) that breaks one, and the one that it breaks most."""
        ...

    def violation(self, positions: FloatArray) -> Violation | None:
        """The one that is broken most at group positions, or None."""
        ...

    def solutions(
        self,
        found: Sequence[FloatArray],
        goal: Goal,
        checker: MotionChecker,
        start: FloatArray,
        seed: int,
    ) -> list[FloatArray]:
        """Free group positions that reach a goal and satisfy the constraints."""
        ...
