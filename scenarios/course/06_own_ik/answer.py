"""Course 6: geometric inverse kinematics of the OpenMANIPULATOR-X."""

from math import acos, atan2, cos, hypot, pi, sin

# Lengths of the arm [m], from its URDF.
BASE_X = 0.012  # joint 1, ahead of the base's origin
SHOULDER_Z = 0.0595  # joint 2, above the base's origin
UPPER_X, UPPER_Z = 0.024, 0.128  # joint 3, seen from joint 2
FORE = 0.124  # joint 4, seen from joint 3
TIP = 0.126  # end_effector_link, seen from joint 4

UPPER = hypot(UPPER_X, UPPER_Z)
BEND = atan2(UPPER_Z, UPPER_X)  # rise of the bent upper arm when all joints are at zero
ROUNDING = 1e-7
LIMITS = [(-pi, pi), (-1.5, 1.5), (-1.5, 1.4), (-1.7, 1.97)]


def ik(x: float, y: float, z: float, pitch: float) -> list[list[float]]:
    """All joint positions that bring the tip to a point [m] with a pitch below the horizontal."""
    facing = atan2(y, x - BASE_X)
    distance = hypot(x - BASE_X, y)
    found = []
    # The arm reaches a point facing it or over its back, its tip pointing outwards or back.
    for heading, ahead in ((facing, distance), (facing + pi, -distance)):
        for slope in (pitch, pi - pitch):
            wrist_x = ahead - TIP * cos(slope)
            wrist_z = z - SHOULDER_Z + TIP * sin(slope)
            found += in_the_plane(heading, wrist_x, wrist_z, slope)
    return [kept for joints in found if (kept := within_limits(joints))]


def in_the_plane(heading: float, wrist_x: float, wrist_z: float, slope: float) -> list[list[float]]:
    """Joint positions for a wrist in the arm's plane, seen from the shoulder: elbow up and down."""
    bend = (wrist_x**2 + wrist_z**2 - UPPER**2 - FORE**2) / (2 * UPPER * FORE)
    if abs(bend) > 1 + ROUNDING:
        return []  # too far away, or too near
    angle = acos(max(-1.0, min(bend, 1.0)))
    found = []
    for elbow in (angle, -angle):
        rise = atan2(wrist_z, wrist_x) - atan2(FORE * sin(elbow), UPPER + FORE * cos(elbow))
        joint2 = BEND - rise
        joint3 = -rise - elbow - joint2
        found.append([wrapped(each) for each in (heading, joint2, joint3, slope - joint2 - joint3)])
    return found


def within_limits(joints: list[float]) -> list[float] | None:
    """The joint positions, if the arm can stand so; rounding puts none beyond a limit."""
    kept = [min(max(each, low), high) for each, (low, high) in zip(joints, LIMITS, strict=True)]
    far = max(abs(one - other) for one, other in zip(joints, kept, strict=True))
    return kept if far < ROUNDING else None


def wrapped(angle: float) -> float:
    """The same angle between -pi and pi."""
    return atan2(sin(angle), cos(angle))
