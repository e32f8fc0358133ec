"""Whether an arm can yield along axes, and press along them, in any of its postures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from harness.core.kinematics import LinkPoses
from harness.core.pose_arrays import quats_from_rotations, rotation_vector
from harness.core.types import FloatArray
from harness.robot.description import RobotDescription

SAMPLES = 32  # postures that are tried besides the named ones
STEP = 1e-6  # of a joint, for the derivative of a link's pose [rad or m]
REST = 0.05
"""Share of a unit motion along an axis, with 1 rad counting as 1 m, that the joints may lack."""


class Postures:
    """An arm in its named states, at its start, and in positions within its limits."""

    def __init__(self, robot: RobotDescription, group: str, link: str, frame: str) -> None:
        """Compute the Jacobians of a link.

        Args:
            robot: The description of the robot.
            group: The planning group that moves.
            link: The link that yields.
            frame: The link in whose axes motions are given; `world` for those of the world.
        """
        indices = list(robot.group_indices(group))
        joints = [robot.movable_joints[index] for index in indices]
        self.joint_names = tuple(joint.name for joint in joints)
        self._limits = np.array([joint.effort for joint in joints])
        starts = [robot.start_positions()]
        starts += [robot.start_positions(state.positions) for state in robot.named_states]
        generator = np.random.default_rng(0)
        for _ in range(SAMPLES):
            drawn = robot.start_positions()
            for index, joint in zip(indices, joints, strict=True):
                drawn[index] = generator.uniform(max(joint.lower, -3), min(joint.upper, 3))
            starts.append(robot.with_mimics(drawn))
        self._jacobians = [_jacobian(robot, indices, link, frame, each) for each in starts]

    def can_yield(self, axis: int) -> bool:
        """Whether the link can move along or about one axis alone in some posture."""
        requested = np.eye(6)[axis]
        for jacobian in self._jacobians:
            moved = jacobian @ (np.linalg.pinv(jacobian, 1e-3) @ requested)
            if np.linalg.norm(moved - requested) < REST:
                return True
        return False

    def least_load(self, wrench: FloatArray) -> tuple[float, str]:
        """The posture in which a wrench takes the smallest share of an effort limit.

        Args:
            wrench: Force and torque along and about the axes, shape (6,) [N, N m].

        Returns:
            The share of the joint that is loaded most there, and the joint's name.
        """
        loads = [np.abs(jacobian.T @ wrench) / self._limits for jacobian in self._jacobians]
        least = min(loads, key=lambda each: float(each.max()))
        return float(least.max()), self.joint_names[int(least.argmax())]


def _jacobian(
    robot: RobotDescription, indices: list[int], link: str, frame: str, positions: FloatArray
) -> FloatArray:
    """The motion of a link by each joint, in the axes of a frame, shape (6, joints)."""
    rows = np.stack(list(_moved(robot, indices, positions)))
    poses = LinkPoses(robot.joints, rows, [link] if frame == "world" else [link, frame])
    turn, place = poses.rotations[link], poses.translations[link]
    back = np.eye(3) if frame == "world" else poses.rotations[frame][0].T
    turned = rotation_vector(quats_from_rotations(turn[1:] @ turn[0].T))
    return np.vstack([back @ (place[1:] - place[0]).T, back @ turned.T]) / STEP


def _moved(
    robot: RobotDescription, indices: list[int], positions: FloatArray
) -> Iterator[FloatArray]:
    """Positions, then the same with each of the joints moved by a step."""
    yield positions
    for index in indices:
        moved = positions.copy()
        moved[index] += STEP
        yield robot.with_mimics(moved)
