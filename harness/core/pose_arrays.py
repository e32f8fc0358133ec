"""Algebra of pose arrays: rows of xyz and quaternion wxyz; single poses broadcast over samples."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


def quat_product(a: FloatArray, b: FloatArray) -> FloatArray:
    """Hamilton product, wxyz, shapes (..., 4)."""
    aw, ax, ay, az = np.moveaxis(a, -1, 0)
    bw, bx, by, bz = np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def conjugate(quat: FloatArray) -> FloatArray:
    """The inverse of unit quaternions, shape (..., 4)."""
    return quat * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(quat: FloatArray, vector: FloatArray) -> FloatArray:
    """Vectors turned by unit quaternions, shape (..., 3)."""
    scalar, imaginary = quat[..., :1], quat[..., 1:]
    twice = 2 * np.cross(imaginary, vector)
    return vector + scalar * twice + np.cross(imaginary, twice)


def rotations_of(quats: FloatArray) -> FloatArray:
    """Rotation matrices of unit quaternions (N, 4), shape (N, 3, 3)."""
    w, x, y, z = np.moveaxis(quats, 1, 0)
    rotations = np.empty((len(quats), 3, 3))
    rotations[:, 0] = np.column_stack(
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]
    )
    rotations[:, 1] = np.column_stack(
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]
    )
    rotations[:, 2] = np.column_stack(
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
    )
    return rotations


def turn_between(before: FloatArray, after: FloatArray) -> FloatArray:
    """Angles from unit quaternions to others [rad], in [0, pi], shape (...,).

    By the chord between them: accurate for small angles, and the same for both signs of each.
    """
    chord = np.minimum(
        np.linalg.norm(after - before, axis=-1), np.linalg.norm(after + before, axis=-1)
    )
    return 4 * np.arcsin(np.minimum(chord / 2, 1.0))


def times_each(rotations: FloatArray, fixed: FloatArray) -> FloatArray:
    """Products of rotations (N, 3, 3) and one matrix (3, k) or vector (3,), (N, 3, k) or (N, 3).

    One product of a large matrix takes a fifth of the time of N small ones.
    """
    return (rotations.reshape(-1, 3) @ fixed).reshape(len(rotations), 3, *fixed.shape[1:])


def compose(T_a_b: FloatArray, T_b_c: FloatArray) -> FloatArray:
    """T_a_c, shape (..., 7)."""
    position = T_a_b[..., :3] + rotate(T_a_b[..., 3:], T_b_c[..., :3])
    return np.concatenate([position, quat_product(T_a_b[..., 3:], T_b_c[..., 3:])], axis=-1)


def relative(T_w_a: FloatArray, T_w_b: FloatArray) -> FloatArray:
    """T_a_b, shape (..., 7)."""
    inverse = conjugate(T_w_a[..., 3:])
    position = rotate(inverse, T_w_b[..., :3] - T_w_a[..., :3])
    return np.concatenate([position, quat_product(inverse, T_w_b[..., 3:])], axis=-1)


def rotation_vector(quat: FloatArray) -> FloatArray:
    """Axis times angle [rad] of unit quaternions, angle in [0, pi], shape (..., 3)."""
    quat = np.where(quat[..., :1] < 0, -quat, quat)
    sine = np.linalg.norm(quat[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, quat[..., :1])
    return quat[..., 1:] * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)


def rotation_angle(quat: FloatArray) -> FloatArray:
    """Angle of unit quaternions [rad], in [0, pi], shape (...,)."""
    return 2 * np.arctan2(np.linalg.norm(quat[..., 1:], axis=-1), np.abs(quat[..., 0]))


def angle_between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Angle between vectors [rad], accurate for small ones too, shape (...,)."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1))


def rotations_about(axis: FloatArray, angles: FloatArray | float) -> FloatArray:
    """Rotation matrices about a unit axis by angles (...,) [rad], shape (..., 3, 3): Rodrigues."""
    angles = np.asarray(angles, dtype=float)
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angles)[..., None, None], np.cos(angles)[..., None, None]
    return np.eye(3) + sine * K + (1.0 - cosine) * (K @ K)


def quats_from_rotations(rotations: FloatArray) -> FloatArray:
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
    quats: FloatArray = rows[np.arange(len(m)), np.argmax(k, axis=1)]
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    return np.where(quats[:, :1] < 0, -quats, quats)
