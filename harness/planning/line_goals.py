"""Where a line or an arc ends: the pose of its link that a goal of any kind means."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import numpy as np
import pinocchio as pin

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik_numeric import pitch_of
from harness.planning.kinematics import PinocchioKinematics
from harness.planning.task import PlanningTask
from harness.ports import Goal, JointGoal, PoseGoal, PositionGoal


def end_pose(
    kinematics: PinocchioKinematics, task: PlanningTask, start: FloatArray, goal: Goal
) -> PoseGoal:
    """The pose goal of a way through space.

    Joint positions mean the pose that they give the TCP, as with Pilz's LIN. A position keeps the
    link turned as it is but for the pitch that is asked for; an arm of fewer than six joints
    cannot: its yaw follows from the point.

    Args:
        kinematics: Of the robot.
        task: Of the motion.
        start: Group positions.
        goal: As stated.
    """
    if isinstance(goal, PoseGoal):
        return goal
    whole = task.space.whole(start)
    if isinstance(goal, JointGoal):
        link = kinematics.description.tcp_link
        return PoseGoal(link, kinematics.link_pose(task.space.whole(goal.positions), link))
    now = kinematics.link_pose(whole, goal.link)
    turned = now.rotation if goal.pitch is None else pitched(now.rotation, goal.pitch)
    if task.space.dof < 6:
        pitch = pitch_of(now.rotation) if goal.pitch is None else goal.pitch
        wanted = PositionGoal(goal.link, goal.position, pitch)
        solutions = kinematics.solve(task.space.group, wanted, whole, task.options.seed)
        if solutions:
            end = task.space.whole(solutions[0])
            turned = kinematics.link_pose(end, goal.link).rotation
    return PoseGoal(goal.link, SE3(turned, np.asarray(goal.position)), goal.position_tolerance)


def pitched(rotation: FloatArray, pitch: float) -> FloatArray:
    """A rotation turned about a level axis until its x axis is `pitch` below the horizontal [rad].

    The heading stays; that of a vertical x axis is where its z axis, or the opposite, points.
    """
    x_axis = rotation[:, 0]
    level = np.array([x_axis[0], x_axis[1], 0.0])
    if np.linalg.norm(level) < 1e-6:
        level = np.sign(-x_axis[2]) * np.array([rotation[0, 2], rotation[1, 2], 0.0])
    level /= np.linalg.norm(level)
    wanted = np.cos(pitch) * level - np.sin(pitch) * np.array([0.0, 0.0, 1.0])
    across = np.cross(x_axis, wanted)
    about = np.array([-level[1], level[0], 0.0])
    angle = np.arctan2(float(across @ about), float(x_axis @ wanted))
    return pin.exp3(angle * about) @ rotation
