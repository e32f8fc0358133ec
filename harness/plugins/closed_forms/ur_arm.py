"""Closed-form inverse kinematics of Universal Robots' arms: all eight branches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import acos, atan2, cos, hypot, inf, pi, remainder, sin, sqrt
from typing import NamedTuple

import numpy as np

from harness.core.spatial import SE3, rotation_from_rpy
from harness.core.types import FloatArray
from harness.robot.mechanism import Joint

_EXACT = 1e-9  # [1] tolerance of a cosine above one
_NEARLY = 1e-3  # [1] tolerance for a candidate near a singularity, see `solve_ur`
_WRIST_SINGULAR = 1e-7  # [rad] below, joints 4 and 6 turn about the same axis


@dataclass(frozen=True)
class UrGeometry:
    """The six Denavit-Hartenberg lengths of a UR arm [m]."""

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
class UrAnswer:
    """The branches within reach, and how far the wrist is out of reach.

    Attributes:
        branches: Joint angles in (-pi, pi], exact for the ideal geometry only, shape (N, 6) with
            N up to 8; by shoulder, then wrist, then elbow, the positive one first.
        excess: How far the wrist is beyond what the upper arm and forearm can span, over all
            branches [m]; 0 when one is within reach.
    """

    branches: FloatArray
    excess: float


@lru_cache(maxsize=64)
def is_ur_like(joints: tuple[Joint, ...]) -> bool:
    """Whether six joints are arranged like a UR's, up to the small angles of a calibration."""
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
    """Solve for all joint angles that put wrist_3_link at a pose in joint 1's parent frame.

    With z the common axis of joints 2, 3 and 4, seen from wrist 3 as (s5 c6, -s5 s6, c5), the
    shoulder follows from the wrist centre, the wrist from z, the elbow from a planar two-link arm.
    The computation uses plain floats, because arrays are slower for so few operations.

    Descriptions contain rounded right angles (1.570796327). Near the wrist singularity the division
    by s5 amplifies the rounding, so that a stretched arm seems slightly too short. The solution is
    returned nevertheless; the refinement decides whether it is valid.

    Args:
        geometry: The lengths of the arm.
        T_base_wrist3: The target pose of the last wrist frame.
        wrist_3_seed: The preferred angle of joint 6 where joints 4 and 6 are parallel.

    References:
        K. P. Hawkins, "Analytic Inverse Kinematics for the Universal Robots UR-5/UR-10 Arms",
        Georgia Institute of Technology, 2013 (the branch structure).
    """
    g = geometry
    (r00, r01, r02), (r10, r11, r12), (r20, r21, r22) = T_base_wrist3.rotation.tolist()
    px, py, pz = T_base_wrist3.translation.tolist()
    east, north = px - g.d6 * r02, py - g.d6 * r12  # of the wrist centre
    height = pz - g.d6 * r22 - g.d1
    radius = hypot(east, north)
    if radius < abs(g.d4) * (1 - _EXACT):
        return UrAnswer(np.empty((0, 6)), 0.0)
    azimuth = atan2(north, east) + 0.5 * pi
    side = acos(max(-1.0, min(1.0, g.d4 / radius))) if radius > 0 else 0.0
    found: list[tuple[float, float, float, float, float, float]] = []
    least = inf
    for q1 in (azimuth + side, azimuth - side):
        s1, c1 = sin(q1), cos(q1)
        x0, x1 = c1 * r00 + s1 * r10, c1 * r01 + s1 * r11  # wrist 3's axes along the upper arm's
        x2 = c1 * r02 + s1 * r12
        z0, z1, z2 = s1 * r00 - c1 * r10, s1 * r01 - c1 * r11, s1 * r02 - c1 * r12
        along = c1 * east + s1 * north
        sine = hypot(z0, z1)
        q5 = atan2(sine, z2)
        if sine < _WRIST_SINGULAR:  # both wrist branches are one
            circle = _Circle(along, height, g.d5 * x0, g.d5 * x1, g.d5 * r20, g.d5 * r21)
            q6 = _free_wrist_3(g.spans, circle, wrist_3_seed)
            s6, c6, wrists = sin(q6), cos(q6), ((1.0, q5, q6),)
        else:
            s6, c6, q6 = -z1 / sine, z0 / sine, atan2(-z1, z0)
            wrists = ((1.0, q5, q6), (-1.0, -q5, q6 - pi if q6 > 0 else q6 + pi))
        s5, c5 = sin(q5), cos(q5)
        shift_x, shift_y = g.d5 * (s6 * x0 + c6 * x1), g.d5 * (s6 * r20 + c6 * r21)
        turn = atan2(
            c5 * (c6 * r20 - s6 * r21) - s5 * r22, c5 * (c6 * x0 - s6 * x1) - s5 * x2
        )  # of the plane's x axis after joint 4
        for wrist, wrist_2, wrist_3 in wrists:
            x, y = along + wrist * shift_x, height + wrist * shift_y
            bend = (x * x + y * y - g.a2 * g.a2 - g.a3 * g.a3) / (2 * g.a2 * g.a3)
            if -1 - _EXACT <= bend <= 1 + _EXACT:
                least = 0.0
            else:
                shortest, longest = g.spans
                reach = hypot(x, y)
                least = min(least, max(reach - longest, shortest - reach))
                if not -1 - _NEARLY <= bend <= 1 + _NEARLY:
                    continue
            bend = max(-1.0, min(1.0, bend))
            q3 = acos(bend)
            aim = atan2(y, x)
            lead = atan2(g.a3 * sqrt(1 - bend * bend), g.a2 + g.a3 * bend)
            rest = turn - aim if wrist > 0 else turn - aim + pi
            found.append((q1, aim - lead, q3, rest + lead - q3, wrist_2, wrist_3))
            found.append((q1, aim + lead, -q3, rest - lead + q3, wrist_2, wrist_3))
    branches = np.array(found).reshape(-1, 6)
    return UrAnswer(pi - (pi - branches) % (2 * pi), 0.0 if least == inf else least)


class _Circle(NamedTuple):
    """Positions of joint 4 when joint 6 is free: `(x, y) + sin(q6) (a, b) + cos(q6) (c, d)`."""

    x: float
    y: float
    a: float
    c: float
    b: float
    d: float

    def squared_distance(self, q6: float) -> float:
        """The squared distance from joint 2 [m^2]."""
        s, c = sin(q6), cos(q6)
        return (self.x + s * self.a + c * self.c) ** 2 + (self.y + s * self.b + c * self.d) ** 2


def _free_wrist_3(spans: tuple[float, float], circle: _Circle, seed: float) -> float:
    """The angle q6 nearest to a seed at which the arm can span the distance to joint 4.

    With joints 4 and 6 parallel, joint 4 lies on a circle about joint 6, and the squared distance
    is `middle + cosine cos(q6) + sine sin(q6)`. The seed itself where no angle is feasible.
    """
    shortest, longest = spans
    if shortest**2 <= circle.squared_distance(seed) <= longest**2:
        return seed
    east, north, west = (circle.squared_distance(angle) for angle in (0.0, 0.5 * pi, pi))
    middle = 0.5 * (east + west)
    cosine, sine = 0.5 * (east - west), north - middle
    swing, phase = hypot(cosine, sine), atan2(sine, cosine)
    shares = [(length**2 - middle) / max(swing, 1e-12) for length in (shortest, longest)]
    turns = [acos(max(-1.0, min(1.0, share))) for share in shares if abs(share) < 1 + _NEARLY]
    angles = [phase + side * turn for turn in turns for side in (1, -1)]
    away = [remainder(angle - seed, 2 * pi) for angle in angles]
    return seed + min(away, key=abs, default=0.0)
