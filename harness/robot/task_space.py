"""Which parts of a pose a planning group can hold, whatever its joints are."""

from __future__ import annotations

from dataclasses import dataclass

from harness.core.spatial import SE3, pitch_of

FREEDOMS = ("x", "y", "z", "pitch", "roll", "yaw")
"""Parts of a pose, in the order in which each further joint of an arm can hold one more; with three
joints an arm holds a position. Roll and pitch together are a tilt, up to a turn about the vertical.
"""


@dataclass(frozen=True)
class TaskSpace:
    """The parts of a link's pose that a group of joints can hold at the same time.

    Attributes:
        held: The parts that it can hold; the others follow from them.
        has_choice: Whether several postures near each other may hold them: with more joints than
            parts, or with a tilt of zero, where a turn about the vertical is left.
    """

    held: tuple[str, ...]
    has_choice: bool

    @classmethod
    def of_joints(cls, count: int) -> TaskSpace:
        """What an arm with a number of joints can hold in general."""
        held = FREEDOMS[: max(3, count)]
        return cls(held, count > len(FREEDOMS) or ("yaw" not in held and "roll" in held))

    @property
    def holds_pose(self) -> bool:
        """Whether any pose can be held."""
        return "yaw" in self.held

    @property
    def holds_tilt(self) -> bool:
        """Whether any rotation can be held up to a turn about the vertical."""
        return "roll" in self.held

    @property
    def holds_pitch(self) -> bool:
        """Whether any angle below the horizontal can be held."""
        return "pitch" in self.held

    def turn_between(self, first: SE3, second: SE3) -> float:
        """The turn between two poses as far as it can be chosen [rad]."""
        if self.holds_pose:
            return first.distance_to(second)[1]
        if self.holds_pitch:
            return abs(pitch_of(first.rotation) - pitch_of(second.rotation))
        return 0.0
