"""Closed-form inverse kinematics of Universal Robots' arms: all eight branches."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from harness.core.spatial import SE3, rotation_from_rpy
from harness.core.types import FloatArray
from harness.robot.description import Joint

_EXACT = 1e-9  # [1] how far a cosine may be above one and still count as one
_NEARLY = 1e-3  # [1] how far above one it still gets a try, see `solve_ur`
_WRIST_SINGULAR = 1e-7  # [rad] below, joints 4 and 6 turn about the same axis


@dataclass(frozen=True)
class UrGeometry:
    """The six lengths that tell one UR from another [m], in Denavit-Hartenberg's words."""

    d1: float
    a2: float
    a3: float
    d4: float
    d5: float
    d6: float

    @classmethod
    def of_joints(cls, joints: tuple[Joint, ...]) -> UrGeometry:
        """Read the lengths from the six joints' origins, base to tip."""
        origin = [joint.pose.translation for joint in joints]
        return cls(
            d1=float(origin[0][2]),
            a2=float(origin[2][0]),
            a3=float(origin[3][0]),
            d4=float(origin[3][2]),
            d5=float(-origin[4][1]),
            d6=float(origin[5][1]),
        )

    @property
    def spans(self) -> tuple[float, float]:
        """Least and largest distance that upper arm and forearm can span [m]."""
        return abs(abs(self.a2) - abs(self.a3)), abs(self.a2) + abs(self.a3)


@dataclass(frozen=True, eq=False)
class UrBranch:
    """One of the eight: where the shoulder, the wrist and the elbow point, and the angles."""

    shoulder: int
    wrist: int
    elbow: int
    positions: FloatArray


@dataclass(frozen=True)
class UrAnswer:
    """The branches that exist, and by how much the others do not.

    Attributes:
        branches: Angles in (-pi, pi], exact for the ideal geometry only.
        excess: How far the wrist is beyond what the upper arm and forearm can span, over the
            branches that were tried [m]; 0 when one was within reach.
        too_close: How far the wrist centre is inside the cylinder about joint 1 that cannot be
            reached [m]; 0 outside it.
    """

    branches: tuple[UrBranch, ...]
    excess: float
    too_close: float


def is_ur_like(joints: tuple[Joint, ...]) -> bool:
    """Whether six joints are arranged as a UR's (up to a calibration's small angles)."""
    if len(joints) != 6 or any(joint.kind == "prismatic" for joint in joints):
        return False
    turns = [(0, 0, 0), (np.pi / 2, 0, 0), (0, 0, 0), (0, 0, 0), (np.pi / 2, 0, 0)]
    turns.append((-np.pi / 2, 0, 0))
    return all(
        np.allclose(joint.axis, (0, 0, 1), atol=1e-6)
        and np.allclose(joint.pose.rotation, rotation_from_rpy(turn), atol=0.05)
        for joint, turn in zip(joints, turns, strict=True)
    )


def solve_ur(geometry: UrGeometry, T_base_wrist3: SE3, wrist_3_seed: float) -> UrAnswer:
    """All joint angles that put wrist_3_link at a pose in the frame that joint 1 stands in.

    With z the common axis of joints 2, 3 and 4, seen from wrist 3 as (s5 c6, -s5 s6, c5), the
    shoulder follows from the wrist centre, the wrist from z, the elbow from a planar two-link arm.
    Descriptions have their right angles rounded (1.570796327), which the division by s5 turns into
    much more beside the wrist's singularity: a stretched arm may then seem a little too short. It
    is answered all the same, and whoever refines the answer finds whether it was.

    Args:
        geometry: The arm's lengths.
        T_base_wrist3: Target.
        wrist_3_seed: Angle given to joint 6 where joints 4 and 6 are parallel and it is free.

    References:
        K. P. Hawkins, "Analytic Inverse Kinematics for the Universal Robots UR-5/UR-10 Arms",
        Georgia Institute of Technology, 2013 (the branch structure).
    """
    g = geometry
    rotation, position = T_base_wrist3.rotation, T_base_wrist3.translation
    center = position - g.d6 * rotation[:, 2]
    radius = float(np.hypot(center[0], center[1]))
    if radius < abs(g.d4) * (1 - _EXACT):
        return UrAnswer((), 0.0, abs(g.d4) - radius)
    azimuth = np.arctan2(center[1], center[0])
    side = np.arccos(np.clip(g.d4 / radius, -1, 1)) if radius > 0 else 0.0
    branches: list[UrBranch] = []
    excesses: list[float] = []
    for shoulder, wrist in product((1, -1), (1, -1)):
        q1 = azimuth + shoulder * side + np.pi / 2
        s1, c1 = np.sin(q1), np.cos(q1)
        z = rotation.T @ np.array([s1, -c1, 0.0])
        sine = float(np.hypot(z[0], z[1]))
        q5 = wrist * np.arctan2(sine, z[2])
        is_singular = sine < _WRIST_SINGULAR
        if is_singular and wrist < 0:
            continue  # both wrist branches are one
        T_shoulder_wrist3 = _shoulder_pose(g, q1).inverse() @ T_base_wrist3
        if is_singular:
            q6 = _free_wrist_3(g, T_shoulder_wrist3, q5, wrist_3_seed)
        else:
            q6 = float(np.arctan2(-wrist * z[1], wrist * z[0]))
        plane = T_shoulder_wrist3 @ _wrist_pose(g, q5, q6).inverse()
        x, y = plane.translation[0], plane.translation[1]
        reach = float(np.hypot(x, y))
        bend = (x * x + y * y - g.a2**2 - g.a3**2) / (2 * g.a2 * g.a3)
        if abs(bend) > 1 + _EXACT:
            shortest, longest = g.spans
            excesses.append(reach - longest if reach > longest else shortest - reach)
        else:
            excesses.append(0.0)
        if abs(bend) > 1 + _NEARLY:
            continue
        turn = np.arctan2(plane.rotation[1, 0], plane.rotation[0, 0])
        for elbow in (1, -1):
            q3 = elbow * np.arccos(np.clip(bend, -1, 1))
            q2 = np.arctan2(y, x) - np.arctan2(g.a3 * np.sin(q3), g.a2 + g.a3 * np.cos(q3))
            angles = np.array([q1, q2, q3, turn - q2 - q3, q5, q6])
            branches.append(UrBranch(shoulder, wrist, elbow, _wrapped(angles)))
    return UrAnswer(tuple(branches), min(excesses, default=0.0), 0.0)


def _free_wrist_3(g: UrGeometry, T_shoulder_wrist3: SE3, q5: float, seed: float) -> float:
    """The angle nearest to a seed at which the arm can span the way to joint 4, which q6 moves.

    With joints 4 and 6 parallel, joint 4 lies on a circle about joint 6, and the square of the way
    is `middle + cosine cos(q6) + sine sin(q6)`. The seed, where no angle will do.
    """

    def squared_way(q6: float) -> float:
        plane = T_shoulder_wrist3 @ _wrist_pose(g, q5, q6).inverse()
        return float(plane.translation[0] ** 2 + plane.translation[1] ** 2)

    shortest, longest = g.spans
    if shortest**2 <= squared_way(seed) <= longest**2:
        return seed
    east, north, west = (squared_way(angle) for angle in (0.0, np.pi / 2, np.pi))
    middle = 0.5 * (east + west)
    cosine, sine = 0.5 * (east - west), north - middle
    swing, phase = float(np.hypot(cosine, sine)), float(np.arctan2(sine, cosine))
    shares = [(length**2 - middle) / max(swing, 1e-12) for length in (shortest, longest)]
    turns = [np.arccos(np.clip(share, -1, 1)) for share in shares if abs(share) < 1 + _NEARLY]
    angles = [phase + side * turn for turn in turns for side in (1, -1)]
    away = [float(np.remainder(angle - seed + np.pi, 2 * np.pi) - np.pi) for angle in angles]
    return seed + min(away, key=abs, default=0.0)


def _shoulder_pose(g: UrGeometry, q1: float) -> SE3:
    """T_base_shoulder: joint 1, then the quarter turn to joint 2's axis."""
    return SE3(
        rotation_from_rpy((0, 0, q1)) @ rotation_from_rpy((np.pi / 2, 0, 0)),
        np.array([0.0, 0.0, g.d1]),
    )


def _wrist_pose(g: UrGeometry, q5: float, q6: float) -> SE3:
    """From behind joint 4's quarter turn to wrist_3_link; cancels that turn and d4 on the left."""
    quarter = rotation_from_rpy((np.pi / 2, 0, 0))
    fourth = SE3(quarter, np.array([0.0, 0.0, g.d4]))
    fifth = SE3(rotation_from_rpy((0, 0, q5)) @ quarter.T, np.array([0.0, 0.0, g.d5]))
    sixth = SE3(rotation_from_rpy((0, 0, q6)), np.array([0.0, 0.0, g.d6]))
    return fourth @ fifth @ sixth


def _wrapped(angles: FloatArray) -> FloatArray:
    """The same angles in (-pi, pi]."""
    return np.pi - np.mod(np.pi - angles, 2 * np.pi)
