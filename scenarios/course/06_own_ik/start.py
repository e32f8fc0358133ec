"""Course 6: geometric inverse kinematics of the OpenMANIPULATOR-X, with the lesson's formula."""

from math import acos, asin, atan, cos, pi, sin, sqrt

# Lengths of the arm [m]. To do: compare them with the robot's URDF.
X_OFFSET = 0.012  # from the origin of the robot to joint 1
Z_OFFSET = 0.0765  # from the origin of the robot up to joint 2
L1, L2 = 0.128, 0.024  # the upper arm: up, and forward
L1C = 0.13023  # its length, sqrt(L1**2 + L2**2)
L3 = 0.124  # the forearm
L4 = 0.126  # the gripper, from joint 4 to the tip


def ik(x: float, y: float, z: float, pitch: float) -> list[float] | None:
    """Joint positions [rad] that bring the tip to a point [m], pitched down by an angle [rad].

    Return one list of four numbers, or a list of such lists; None where the point is out of reach.
    """
    joint1 = atan(y / (x - X_OFFSET))
    wrist_x = sqrt((x - X_OFFSET) ** 2 + y**2) - L4 * cos(pitch)
    wrist_z = z - Z_OFFSET + L4 * sin(pitch)
    far = sqrt(wrist_x**2 + wrist_z**2)
    slope = asin(wrist_z / far)
    at_shoulder = acos((L1C**2 + far**2 - L3**2) / (2 * L1C * far))
    at_elbow = acos((L1C**2 + L3**2 - far**2) / (2 * L1C * L3))
    bend = atan(L2 / L1)
    joint2 = pi / 2 - bend - slope - at_shoulder
    joint3 = pi / 2 + bend - at_elbow
    return [joint1, joint2, joint3, pitch - joint2 - joint3]
