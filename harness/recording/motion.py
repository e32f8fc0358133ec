"""What moved in a run: the part of a recording from which distances are measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.recording.signals import Signals


@dataclass(frozen=True, eq=False)
class Motion:
    """Positions of joints and objects; row i of each array belongs to `times[i]`.

    Attributes:
        times: Simulation time of every sample [s], shape (N,).
        joint_positions: Joint positions in description order, shape (N, n).
        object_poses: T_world_object (xyz, quat wxyz) by name, NaN while absent, shape (N, 7) each.
    """

    times: FloatArray
    joint_positions: FloatArray
    object_poses: Mapping[str, FloatArray]

    @classmethod
    def of(cls, signals: Signals) -> Motion:
        """The motion of a recording."""
        return cls(signals.times, signals.joint_positions, signals.object_poses)

    def at(self, samples: IntArray) -> Motion:
        """The motion at a part of the samples."""
        return Motion(
            self.times[samples],
            self.joint_positions[samples],
            {name: poses[samples] for name, poses in self.object_poses.items()},
        )

    def between(self, owners: IntArray, shares: FloatArray) -> Motion:
        """The motion between samples, linear from one to the next.

        Args:
            owners: The sample before each moment, shape (M,).
            shares: Where each moment is between that sample and the next, 0 to 1, shape (M,).
        """
        share = shares[:, None]

        def mixed(rows: FloatArray) -> FloatArray:
            return (1 - share) * rows[owners] + share * rows[owners + 1]

        def mixed_poses(poses: FloatArray) -> FloatArray:
            near = np.sum(poses[owners, 3:] * poses[owners + 1, 3:], axis=1) >= 0
            after = np.where(near[:, None], poses[owners + 1, 3:], -poses[owners + 1, 3:])
            turned = (1 - share) * poses[owners, 3:] + share * after
            turned = turned / np.linalg.norm(turned, axis=1, keepdims=True)
            return np.hstack([mixed(poses[:, :3]), turned])

        return Motion(
            mixed(self.times[:, None])[:, 0],
            mixed(self.joint_positions),
            {name: mixed_poses(poses) for name, poses in self.object_poses.items()},
        )
