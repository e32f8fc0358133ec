"""Forward kinematics of a tree of links, with numpy alone: a robot's or that of a saved run."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.pose_arrays import quats_from_rotations, rotations_about, times_each
from harness.core.spatial import SE3
from harness.core.types import FloatArray

JointKind = Literal["fixed", "revolute", "continuous", "prismatic"]


@dataclass(frozen=True, eq=False)
class LinkJoint:
    """How a link moves in the frame of its parent link.

    Attributes:
        pose: The pose T_parent_joint at zero; the child link's frame is the joint's.
        axis: Unit vector in the joint frame, shape (3,).
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    pose: SE3
    axis: FloatArray

    @property
    def is_movable(self) -> bool:
        """Whether the joint has a position."""
        return self.kind != "fixed"

    def at(self, position: float) -> SE3:
        """T_parent_child of a movable joint at a position [rad or m]."""
        return LinkPoses([self], np.array([[position]])).at(0)[self.child]

    def poses(self, positions: FloatArray) -> FloatArray:
        """T_parent_child of a movable joint at positions [rad or m], (N,) -> (N, 7)."""
        return LinkPoses([self], positions[:, None]).rows(self.child)


class LinkPoses:
    """Poses T_root_link of links for N samples.

    Attributes:
        rotations: The rotations by link, shape (N, 3, 3).
        translations: The translations by link [m], shape (N, 3).
    """

    def __init__(
        self,
        joints: Sequence[LinkJoint],
        joint_positions: FloatArray,
        links: Collection[str] | None = None,
    ) -> None:
        """Compute the poses of some links, and of those that carry them.

        Args:
            joint_positions: Positions of the movable ones, in their order, shape (N, n) or (n,).
            links: The links whose poses are needed; all by default.
        """
        samples = np.atleast_2d(np.asarray(joint_positions, dtype=float))
        count = len(samples)
        roots = {joint.parent for joint in joints} - {joint.child for joint in joints}
        self.rotations = dict.fromkeys(roots, np.tile(np.eye(3), (count, 1, 1)))
        self.translations = dict.fromkeys(roots, np.zeros((count, 3)))
        needed = _with_carriers(joints, links)
        column = -1
        for joint in joints:
            column += joint.is_movable
            if joint.child not in needed:
                continue
            turns, places = self.rotations[joint.parent], self.translations[joint.parent]
            places = places + times_each(turns, joint.pose.translation)
            turns = times_each(turns, joint.pose.rotation)
            if joint.kind == "prismatic":
                places = places + times_each(turns, joint.axis) * samples[:, column, None]
            elif joint.is_movable:
                turns = turns @ rotations_about(joint.axis, samples[:, column])
            self.rotations[joint.child] = turns
            self.translations[joint.child] = places

    def at(self, sample: int) -> dict[str, SE3]:
        """T_root_link of every link in one sample."""
        return {
            link: SE3(rotations[sample], self.translations[link][sample])
            for link, rotations in self.rotations.items()
        }

    def rows(self, link: str) -> FloatArray:
        """T_root_link of a link: position, then quaternion wxyz, shape (N, 7)."""
        quats = quats_from_rotations(self.rotations[link])
        return np.hstack([self.translations[link], quats])


def _with_carriers(joints: Sequence[LinkJoint], links: Collection[str] | None) -> set[str]:
    """The links, and all that carry them; all links when None."""
    needed = {joint.child for joint in joints} if links is None else {*links}
    for joint in reversed(joints):
        if joint.child in needed:
            needed.add(joint.parent)
    return needed
