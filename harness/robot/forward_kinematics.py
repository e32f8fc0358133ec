"""Forward kinematics: poses of links from joint positions, of one state or of many samples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from harness.core.pose_arrays import times_each
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.robot.description import Joint, RobotDescription
from harness.robot.tree import joints_to


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
        needed = {
            joint.child for link in links or () for joint in joints_to(link, description.joints)
        }
        for joint in description.joints:
            if links is not None and joint.child not in needed:
                continue
            R = self.rotations[joint.parent]
            p = self.translations[joint.parent] + times_each(R, joint.pose.translation)
            R = times_each(R, joint.pose.rotation)
            if joint.is_movable:
                value = samples[:, description.joint_index[joint.name]]
                if joint.kind == "prismatic":
                    p = p + times_each(R, joint.axis) * value[:, None]
                else:
                    R = R @ rotations_about(joint.axis, value)
            self.rotations[joint.child] = R
            self.translations[joint.child] = p


def link_poses(
    joints: Iterable[Joint], positions: Mapping[str, float], root: str = "world"
) -> dict[str, SE3]:
    """T_root_link of every link in one state.

    Args:
        joints: The joints, parents before children.
        positions: The position of every joint by name, mimic joints included [rad or m]; 0 where
            one is missing.
        root: The link without a parent joint.
    """
    poses = {root: SE3.identity()}
    for joint in joints:
        pose = poses[joint.parent] @ joint.pose
        if joint.is_movable:
            pose = pose @ motion(joint, positions.get(joint.name, 0.0))
        poses[joint.child] = pose
    return poses


def robot_poses(description: RobotDescription, joint_positions: FloatArray) -> dict[str, SE3]:
    """T_world_link of every link at joint positions in description order, shape (n,)."""
    named = zip(description.joint_names, map(float, joint_positions), strict=True)
    return link_poses(description.joints, dict(named))


def motion(joint: Joint, position: float) -> SE3:
    """Transform of a joint's frame by its position."""
    if joint.kind == "prismatic":
        return SE3(np.eye(3), position * joint.axis)
    return SE3(rotations_about(joint.axis, np.array([position]))[0], np.zeros(3))


def rotations_about(axis: FloatArray, angles: FloatArray) -> FloatArray:
    """Rotation matrices about a unit axis, shape (N, 3, 3): Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return np.eye(3) + sine * K + (1.0 - cosine) * (K @ K)


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
