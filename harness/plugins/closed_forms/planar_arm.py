"""Closed-form inverse kinematics of OpenMANIPULATOR-X: position and pitch, four branches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.robot.mechanism import Joint

_EXACT = 1e-9  # [1] tolerance of a cosine above one


@dataclass(frozen=True, eq=False)
class PlanarArm:
    """A turntable with a three-joint arm that moves in a vertical plane.

    Vectors are (forward, up) in the plane at zero, shape (2,) [m].

    Attributes:
        axis: The translation of T_base_turntable, a point on joint 1's axis, shape (3,).
        shoulder: The vector from that point to joint 2.
        upper: The vector from joint 2 to joint 3.
        fore: The vector from joint 3 to joint 4.
        tip: The vector from joint 4 to the target link.
    """

    axis: FloatArray
    shoulder: FloatArray
    upper: FloatArray
    fore: FloatArray
    tip: FloatArray

    @classmethod
    def of_joints(cls, joints: tuple[Joint, ...], T_last_link: SE3) -> PlanarArm:
        """Read the vectors from the four joints' origins and the link after the last joint."""
        origin = [joint.pose.translation for joint in joints]
        return cls(
            axis=origin[0],
            shoulder=origin[1][[0, 2]],
            upper=origin[2][[0, 2]],
            fore=origin[3][[0, 2]],
            tip=T_last_link.translation[[0, 2]],
        )


@dataclass(frozen=True, eq=False)
class PlanarAnswer:
    """Joint angles of the branches within reach, and how far the target is out of reach [m]."""

    solutions: tuple[FloatArray, ...]
    excess: float


def is_planar_arm(joints: tuple[Joint, ...], T_last_link: SE3) -> bool:
    """Whether four joints are a turntable and three parallel joints in a plane through its axis."""
    if len(joints) != 4 or any(joint.kind == "prismatic" for joint in joints):
        return False
    axes = [(0, 0, 1), (0, 1, 0), (0, 1, 0), (0, 1, 0)]
    return (
        all(
            np.allclose(joint.axis, axis, atol=1e-9)
            and np.allclose(joint.pose.rotation, np.eye(3), atol=1e-9)
            for joint, axis in zip(joints, axes, strict=True)
        )
        and all(abs(joint.pose.translation[1]) < 1e-9 for joint in joints[1:])
        and abs(T_last_link.translation[1]) < 1e-9
        and bool(np.allclose(T_last_link.rotation, np.eye(3), atol=1e-9))
    )


def headings(arm: PlanarArm, position: FloatArray) -> tuple[float, float]:
    """The two angles of joint 1 whose plane contains a point in the base frame."""
    facing = float(np.arctan2(position[1] - arm.axis[1], position[0] - arm.axis[0]))
    return facing, facing + np.pi


def pitch_in_plane(heading: float, x_axis: FloatArray) -> float:
    """Pitch of a direction that lies nearly in the plane at a heading, (-pi, pi]."""
    forward = x_axis[0] * np.cos(heading) + x_axis[1] * np.sin(heading)
    return float(np.arctan2(-x_axis[2], forward))


def pitches_below(heading: float, down: FloatArray, pitch: float) -> tuple[float, ...]:
    """Pitches in the plane at a heading that give a pitch below the world's horizontal.

    The link's x axis at an in-plane pitch b is cos(b) forward - sin(b) up, in the base frame; its
    part along `down` must be sin(pitch). On a level base that is `pitch`, pointing away from the
    base, and pi - pitch, pointing to it.

    Args:
        heading: The heading of the plane [rad].
        down: The world's downward direction in the base frame, shape (3,).
        pitch: The angle below the horizontal [rad].

    Returns:
        Two angles [rad], or none where the plane cannot contain that pitch.
    """
    ahead = float(down[0] * np.cos(heading) + down[1] * np.sin(heading))
    below = float(-down[2])
    size, shift = float(np.hypot(ahead, below)), float(np.arctan2(below, ahead))
    if size < abs(np.sin(pitch)) - 1e-12 or size == 0.0:
        return ()
    turn = float(np.arccos(np.clip(np.sin(pitch) / size, -1.0, 1.0)))
    return tuple(
        float(np.arctan2(np.sin(angle), np.cos(angle))) for angle in (shift - turn, shift + turn)
    )


def solve_planar(
    arm: PlanarArm, position: FloatArray, heading: float, pitch: float
) -> PlanarAnswer:
    """Solve both elbow branches for a point, a heading and a pitch in the plane.

    Args:
        arm: The lengths of the arm.
        position: The target in the base frame [m], shape (3,).
        heading: The angle of joint 1 [rad]; one of `headings`.
        pitch: The sum of joints 2, 3 and 4 [rad], downwards.
    """
    offset = position - arm.axis
    forward = offset[0] * np.cos(heading) + offset[1] * np.sin(heading)
    target = np.array([forward, offset[2]]) - arm.shoulder - _turned(arm.tip, pitch)
    upper, fore = np.linalg.norm(arm.upper), np.linalg.norm(arm.fore)
    reach = float(np.linalg.norm(target))
    bend = float((reach**2 - upper**2 - fore**2) / (2 * upper * fore))
    if abs(bend) > 1 + _EXACT:
        excess = reach - (upper + fore) if bend > 0 else abs(upper - fore) - reach
        return PlanarAnswer((), float(excess))
    upper_rise = np.arctan2(arm.upper[1], arm.upper[0])  # elevations at zero
    fore_rise = np.arctan2(arm.fore[1], arm.fore[0])
    solutions = []
    for elbow in (1, -1):
        delta = elbow * np.arccos(np.clip(bend, -1, 1))
        rise = np.arctan2(target[1], target[0])
        rise -= np.arctan2(fore * np.sin(delta), upper + fore * np.cos(delta))
        q2 = upper_rise - rise
        q3 = fore_rise - q2 - (rise + delta)
        angles = np.array([heading, q2, q3, pitch - q2 - q3])
        solutions.append(np.pi - np.mod(np.pi - angles, 2 * np.pi))
    return PlanarAnswer(tuple(solutions), 0.0)


def _turned(vector: FloatArray, pitch: float) -> FloatArray:
    """A plane vector turned downwards by an angle about the plane's y axis."""
    cosine, sine = np.cos(pitch), np.sin(pitch)
    return np.array([cosine * vector[0] + sine * vector[1], -sine * vector[0] + cosine * vector[1]])
