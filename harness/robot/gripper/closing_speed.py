"""How fast a gripper closes."""

from __future__ import annotations

import numpy as np

from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper

CLOSING_SPEED = 0.075
"""Rate at which the pad gap changes [m/s]; RH-P12-RN(A) specification table, ROBOTIS e-manual."""

VELOCITY_SHARE = 0.8
"""Share of the joint's velocity limit that is commanded at most: fingers bounce when they meet."""


def joint_speed(description: RobotDescription, gripper: Gripper) -> float:
    """Speed of the gripper's joint that changes the pad gap at CLOSING_SPEED, within its limit."""
    limit = VELOCITY_SHARE * description.joint_by_name[gripper.joint].velocity
    positions, gaps = gripper.widths[:, 0], gripper.widths[:, 1]
    if len(positions) < 2:
        return min(limit, abs(gripper.closed_position - gripper.open_position))
    steepest = float(np.abs(np.diff(gaps) / np.diff(positions)).max())
    return min(limit, CLOSING_SPEED / steepest)
