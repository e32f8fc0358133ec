"""Which parts of a pose a planning group can hold, whatever its joints are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.kinematics import LinkPoses
from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray, IntArray

FREEDOMS = ("x", "y", "z", "pitch", "roll", "yaw")
"""Parts of a pose, in the order in which each further joint of an arm can hold one more; with three
joints an arm holds a position. Roll and pitch together are a tilt, up to a turn about the vertical.
"""


@dataclass(frozen=True)
class TaskSpace:
    """The parts of a link's pose that a group of joints can hold at the same time.

    Attributes:
        has_choice: Whether several postures near each other may hold them: with more joints than
            parts, or with a tilt of zero, where a turn about the vertical is left.
    """

    held: tuple[str, ...]
    has_choice: bool

    @classmethod
    def of_joints(cls, count: int, rank: int | None = None) -> TaskSpace:
        """What a group of joints can hold.

        Args:
            rank: The number of ways in which they move the link, 6 at most; by default `count`.
        """
        held = FREEDOMS[: max(3, count if rank is None else rank)]
        is_redundant = count > (len(FREEDOMS) if rank is None else rank)
        return cls(held, is_redundant or ("yaw" not in held and "roll" in held))

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


SAMPLES = 8  # configurations of a mechanism that show its rank; one is singular with probability 0
LEAST_MOTION = 0.01
"""The least singular value that counts, as a share of the largest.

Joints that are a degree out of parallel move a link in another way by 0.02 of their own.
"""
DIFFERENCE = 1e-6  # of a joint, for the derivative of the link's pose [rad or m]


def mechanism_rank(
    poses_at: Callable[[FloatArray], LinkPoses], limits: FloatArray, moving: IntArray, link: str
) -> int:
    """In how many ways some joints move a link: the rank of its Jacobian, where it is largest.

    Translations count as shares of the longest lever of a joint that turns.

    Args:
        limits: Lower and upper position limits of all joints, shape (2, n).
    """
    lower, upper = np.maximum(limits[0], -np.pi), np.minimum(limits[1], np.pi)
    samples = lower + np.random.default_rng(0).random((SAMPLES, len(lower))) * (upper - lower)
    steps = np.vstack([np.zeros(len(lower)), DIFFERENCE * np.eye(len(lower))[moving]])
    poses = poses_at((samples[:, None] + steps).reshape(-1, len(lower)))
    places = poses.translations[link].reshape(SAMPLES, -1, 3)
    turns = poses.rotations[link].reshape(SAMPLES, -1, 3, 3)
    shifts = (places[:, 1:] - places[:, :1]) / DIFFERENCE  # (samples, joints, 3)
    rates = (turns[:, 1:] @ np.swapaxes(turns[:, :1], 2, 3) - np.eye(3)) / DIFFERENCE
    rotations = np.stack([rates[..., 2, 1], rates[..., 0, 2], rates[..., 1, 0]], axis=-1)
    is_turning = np.linalg.norm(rotations, axis=2) > 0.5
    lever = np.linalg.norm(shifts, axis=2)[is_turning].max(initial=0.0) or 1.0
    jacobians = np.concatenate([shifts / lever, rotations], axis=2)
    sizes = np.linalg.svd(jacobians, compute_uv=False)
    return int((sizes > LEAST_MOTION * sizes[:, :1]).sum(axis=1).max())
