"""The time that a gripper takes to close."""

from __future__ import annotations

import math

from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper
from harness.robot.gripper.closing_speed import joint_speed


def closing_time(
    description: RobotDescription, gripper: Gripper, start: float, goal: float
) -> float:
    """The time that the gripper's joint takes from one position to another, in hundredths [s]."""
    speed = joint_speed(description, gripper)
    rise = speed / description.joint_by_name[gripper.joint].acceleration
    return on_hundredths(abs(goal - start) / speed + rise)


def on_hundredths(duration: float) -> float:
    """A duration lengthened to the next hundredth, the period of a trajectory's set points [s]."""
    return math.ceil(100 * duration - 1e-6) / 100
