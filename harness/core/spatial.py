"""Rigid-body poses as rotation matrix and translation; quaternions inside the program are wxyz."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.pose_arrays import rotations_of
from harness.core.types import FloatArray

Vector = Sequence[float] | FloatArray


def rotation_from_rpy(rpy: Vector) -> FloatArray:
    """Rotation of URDF's fixed-axis roll, pitch, yaw [rad]: Rz Ry Rx, shape (3, 3)."""
    angles = np.asarray(rpy, dtype=float)
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_rotation(rotation: FloatArray) -> FloatArray:
    """Fixed-axis roll, pitch, yaw of a rotation, stable at pitch ±π/2, shape (3,).

    Roll is computed after undoing yaw, so that it compensates for the error of yaw near the
    singularity.
    """
    yaw = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
    sine, cosine = np.sin(yaw), np.cos(yaw)
    pitch = np.arctan2(-rotation[2, 0], cosine * rotation[0, 0] + sine * rotation[1, 0])
    roll = np.arctan2(
        sine * rotation[0, 2] - cosine * rotation[1, 2],
        cosine * rotation[1, 1] - sine * rotation[0, 1],
    )
    return np.array([roll, pitch, yaw])


def rotation_from_quat_wxyz(quat_wxyz: Vector) -> FloatArray:
    """Rotation matrix of a quaternion, which is normalised first, shape (3, 3)."""
    quat = np.asarray(quat_wxyz, dtype=float)
    return rotations_of(quat[None] / np.linalg.norm(quat))[0]


def quat_wxyz_from_rotation(rotation: FloatArray) -> FloatArray:
    """Unit quaternion with w >= 0 of a rotation matrix, shape (4,).

    References:
        S. W. Shepperd, "Quaternion from Rotation Matrix", 1978: the largest
        of the four candidates is taken as divisor.
    """
    m = rotation
    candidates = np.array(
        [
            1 + m[0, 0] + m[1, 1] + m[2, 2],
            1 + m[0, 0] - m[1, 1] - m[2, 2],
            1 - m[0, 0] + m[1, 1] - m[2, 2],
            1 - m[0, 0] - m[1, 1] + m[2, 2],
        ]
    )
    largest = int(np.argmax(candidates))
    rows = [
        [candidates[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], candidates[1], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
        [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], candidates[2], m[1, 2] + m[2, 1]],
        [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], candidates[3]],
    ]
    quat = np.array(rows[largest])
    quat /= np.linalg.norm(quat)
    return -quat if quat[0] < 0 else quat


def wxyz_from_xyzw(quat_xyzw: Vector) -> FloatArray:
    """Reorder a quaternion from ROS's order to the program's."""
    x, y, z, w = quat_xyzw
    return np.array([w, x, y, z], dtype=float)


def xyzw_from_wxyz(quat_wxyz: Vector) -> FloatArray:
    """Reorder a quaternion from the program's order to ROS's, Pinocchio's and SciPy's."""
    w, x, y, z = quat_wxyz
    return np.array([x, y, z, w], dtype=float)


def pitch_of(rotation: FloatArray) -> float:
    """Angle of a frame's x axis below the horizontal [rad], -pi/2 to pi/2."""
    x_axis = rotation[:, 0]
    return float(np.arctan2(-x_axis[2], np.hypot(x_axis[0], x_axis[1])))


@dataclass(frozen=True, eq=False)
class SE3:
    """A pose T_a_b of frame b in frame a. ``T_a_c = T_a_b @ T_b_c``.

    Attributes:
        rotation: Axes of b in a, shape (3, 3).
        translation: Origin of b in a [m], shape (3,).
    """

    rotation: FloatArray
    translation: FloatArray

    @classmethod
    def identity(cls) -> SE3:
        """The identity transform."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def from_xyz_rpy(cls, xyz: Vector = (0, 0, 0), rpy: Vector = (0, 0, 0)) -> SE3:
        """Pose of a URDF ``<origin xyz rpy>``."""
        return cls(rotation_from_rpy(rpy), np.asarray(xyz, dtype=float))

    @classmethod
    def from_xyz_quat(cls, xyz: Vector, quat_wxyz: Vector) -> SE3:
        """Pose of a position [m] and a quaternion in wxyz order."""
        return cls(rotation_from_quat_wxyz(quat_wxyz), np.asarray(xyz, dtype=float))

    @classmethod
    def from_vector(cls, pose: Vector) -> SE3:
        """Inverse of `as_vector`."""
        values = np.asarray(pose, dtype=float)
        return cls.from_xyz_quat(values[:3], values[3:])

    @classmethod
    def from_matrix(cls, matrix: FloatArray) -> SE3:
        """Pose of a homogeneous matrix, shape (4, 4)."""
        return cls(np.array(matrix[:3, :3]), np.array(matrix[:3, 3]))

    def __matmul__(self, other: SE3) -> SE3:
        return SE3(
            self.rotation @ other.rotation, self.rotation @ other.translation + self.translation
        )

    def inverse(self) -> SE3:
        """T_b_a."""
        transposed = self.rotation.T
        return SE3(transposed, -transposed @ self.translation)

    def apply(self, points: FloatArray) -> FloatArray:
        """Points given in b, expressed in a, shape (..., 3)."""
        return points @ self.rotation.T + self.translation

    @property
    def quat_wxyz(self) -> FloatArray:
        """Rotation as a unit quaternion with w >= 0, shape (4,)."""
        return quat_wxyz_from_rotation(self.rotation)

    def as_vector(self) -> FloatArray:
        """Position [m], then quaternion wxyz: shape (7,). The form recorded in signals."""
        return np.concatenate([self.translation, self.quat_wxyz])

    def matrix(self) -> FloatArray:
        """Homogeneous matrix, shape (4, 4)."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation
        return matrix

    def distance_to(self, other: SE3) -> tuple[float, float]:
        """Distance [m] and rotation angle [rad] between two poses in the same frame."""
        turn = self.rotation.T @ other.rotation
        sine = 0.5 * np.linalg.norm(
            [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
        angle = float(np.arctan2(sine, 0.5 * (np.trace(turn) - 1)))
        return float(np.linalg.norm(other.translation - self.translation)), angle
