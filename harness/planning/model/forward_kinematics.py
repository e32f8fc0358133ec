"""Computes link poses of many samples as arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.types import FloatArray
from harness.robot.chain import rotations_about
from harness.robot.description import RobotDescription


class LinkPoses:
    """Poses T_world_link of every link for N samples.

    Attributes:
        rotations: The rotations by link, shape (N, 3, 3).
        translations: The translations by link [m], shape (N, 3).
    """

    def __init__(
        self,
        description: RobotDescription,
        joint_positions: FloatArray,
        links: Sequence[str] | None = None,
    ) -> None:
        """Compute the poses of some links (all by default) at positions (N, n)."""
        samples = np.atleast_2d(np.asarray(joint_positions, dtype=float))
        count = len(samples)
        self.rotations: dict[str, FloatArray] = {"world": np.tile(np.eye(3), (count, 1, 1))}
        self.translations: dict[str, FloatArray] = {"world": np.zeros((count, 3))}
        needed = _ancestors(description, links)
        for joint in description.joints:
            if joint.child not in needed:
                continue
            R = self.rotations[joint.parent]
            p = self.translations[joint.parent] + R @ joint.pose.translation
            R = R @ joint.pose.rotation
            if joint.is_movable:
                value = samples[:, description.joint_index[joint.name]]
                if joint.kind == "prismatic":
                    p = p + (R @ joint.axis) * value[:, None]
                else:
                    R = R @ rotations_about(joint.axis, value)
            self.rotations[joint.child] = R
            self.translations[joint.child] = p


def _ancestors(description: RobotDescription, links: Sequence[str] | None) -> set[str]:
    if links is None:
        return set(description.link_names)
    parent = {joint.child: joint.parent for joint in description.joints}
    needed: set[str] = set()
    for link in links:
        name: str | None = link
        while name is not None and name not in needed:
            needed.add(name)
            name = parent.get(name)
    return needed


def quats_wxyz(rotations: FloatArray) -> FloatArray:
    """Convert rotations (N, 3, 3) to unit quaternions with w >= 0, shape (N, 4), by Shepperd."""
    m = rotations
    diagonal = m[:, [0, 1, 2], [0, 1, 2]]
    trace = diagonal.sum(axis=1)
    candidates = np.column_stack([1 + trace, 1 + 2 * diagonal - trace[:, None]])
    a, b, c = m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]
    d, e, f = m[:, 0, 1] + m[:, 1, 0], m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1]
    k = candidates
    rows = np.stack(
        [
            np.column_stack([k[:, 0], a, b, c]),
            np.column_stack([a, k[:, 1], d, e]),
            np.column_stack([b, d, k[:, 2], f]),
            np.column_stack([c, e, f, k[:, 3]]),
        ],
        axis=1,
    )
    quats = rows[np.arange(len(m)), np.argmax(k, axis=1)]
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    return np.where(quats[:, :1] < 0, -quats, quats)
