"""Converts a goal of any kind to the end pose of a line or an arc."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import numpy as np
import pinocchio as pin

from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.task import PlanningTask
from harness.ports.goals import Goal, JointGoal, PoseGoal, PositionGoal


def end_pose(
    kinematics: PinocchioKinematics, task: PlanningTask, start: FloatArray, goal: Goal
) -> PoseGoal:
    """Convert a goal to the end pose of a Cartesian path.

    Joint positions stand for the TCP pose that they produce, as in Pilz's LIN. A position goal
    keeps the link's orientation except for a requested pitch; what the group cannot hold
    follows from the position.
    """
    if isinstance(goal, PoseGoal):
        return goal
    whole = task.space.whole(start)
    if isinstance(goal, JointGoal):
        link = kinematics.description.tcp_link
        return PoseGoal(link, kinematics.link_pose(task.space.whole(goal.positions), link))
    now = kinematics.link_pose(whole, goal.link)
    turned = now.rotation if goal.pitch is None else pitched(now.rotation, goal.pitch)
    held = task.space.task_space
    if not held.holds_pose:
        pitch = pitch_of(now.rotation) if goal.pitch is None else goal.pitch
        reduced = PositionGoal(goal.link, goal.position, pitch)
        if held.holds_tilt:
            reduced = PoseGoal(goal.link, SE3(turned, np.asarray(goal.position)))
        solutions = kinematics.solve(task.space.group, reduced, whole, task.options.seed)
        if solutions:
            end = task.space.whole(solutions[0])
            turned = kinematics.link_pose(end, goal.link).rotation
    pose = SE3(turned, np.asarray(goal.position))
    if held.holds_tilt and not held.holds_pose:  # several turns about the vertical are possible
        return PoseGoal(goal.link, pose, goal.position_tolerance, orientation_tolerance=np.pi)
    return PoseGoal(goal.link, pose, goal.position_tolerance)


def pitched(rotation: FloatArray, pitch: float) -> FloatArray:
    """A rotation turned about a level axis until its x axis is `pitch` below the horizontal [rad].

    The heading is unchanged; for a vertical x axis it is that of the z axis or its opposite.
    """
    x_axis = rotation[:, 0]
    level = np.array([x_axis[0], x_axis[1], 0.0])
    if np.linalg.norm(level) < 1e-6:
        level = np.sign(-x_axis[2]) * np.array([rotation[0, 2], rotation[1, 2], 0.0])
    level /= np.linalg.norm(level)
    direction = np.cos(pitch) * level - np.sin(pitch) * np.array([0.0, 0.0, 1.0])
    across = np.cross(x_axis, direction)
    about = np.array([-level[1], level[0], 0.0])
    angle = np.arctan2(float(across @ about), float(x_axis @ direction))
    return pin.exp3(angle * about) @ rotation
