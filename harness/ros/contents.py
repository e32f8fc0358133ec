"""Messages as the plain content that commands are recorded with, and outcomes as messages."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.ros.action_server import Status
from harness.ros.control.goals import Code
from harness.ros.control.gripper import Gripped
from harness.ros.control.trajectory import Finished, Tracking
from harness.ros.interfaces import FOLLOW, GRIPPER, message, seconds, stamp

POINT = "trajectory_msgs/msg/JointTrajectoryPoint"


def trajectory_content(trajectory: Any) -> dict[str, Any]:
    """The content of a JointTrajectory."""
    return {
        "joint_names": [str(name) for name in trajectory.joint_names],
        "stamp": seconds(trajectory.header.stamp),
        "points": [
            {
                "time": seconds(point.time_from_start),
                "positions": point.positions.tolist(),
                "velocities": point.velocities.tolist(),
                "accelerations": point.accelerations.tolist(),
            }
            for point in trajectory.points
        ],
    }


def follow_content(goal: Any) -> dict[str, Any]:
    """The content of a goal of FollowJointTrajectory."""
    return {
        **trajectory_content(goal.trajectory),
        "path_tolerance": [_tolerance(each) for each in goal.path_tolerance],
        "goal_tolerance": [_tolerance(each) for each in goal.goal_tolerance],
        "goal_time": seconds(goal.goal_time_tolerance),
    }


def gripper_content(goal: Any) -> dict[str, Any]:
    """The content of a goal of GripperCommand."""
    return {"position": goal.command.position, "max_effort": goal.command.max_effort}


def _tolerance(each: Any) -> dict[str, Any]:
    return {"name": str(each.name), "position": each.position, "velocity": each.velocity}


def follow_result(outcome: Finished) -> tuple[Status, Any]:
    """State and result of a trajectory that ended."""
    status = Status.SUCCEEDED if outcome.code == Code.SUCCESSFUL else Status.ABORTED
    content = message(
        f"{FOLLOW}_Result", error_code=int(outcome.code), error_string=outcome.message
    )
    return status, content


def gripper_result(outcome: Gripped) -> tuple[Status, Any]:
    """State and result of a gripper's motion; one that stalls on an object has succeeded."""
    is_done = outcome.reached_goal or outcome.stalled
    content = message(
        f"{GRIPPER}_Result",
        position=outcome.position,
        effort=outcome.effort,
        stalled=outcome.stalled,
        reached_goal=outcome.reached_goal,
    )
    return (Status.SUCCEEDED if is_done else Status.ABORTED), content


def follow_feedback(tracking: Tracking, names: tuple[str, ...]) -> Any:
    """Feedback of a trajectory that is followed."""

    def point(motion: FloatArray) -> Any:
        positions, velocities = np.ascontiguousarray(motion)
        return message(POINT, positions=positions, velocities=velocities)

    return message(
        f"{FOLLOW}_Feedback",
        header=message("std_msgs/msg/Header", stamp=stamp(tracking.time)),
        joint_names=list(names),
        desired=point(tracking.desired),
        actual=point(tracking.actual),
        error=point(tracking.desired - tracking.actual),
    )
