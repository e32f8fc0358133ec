"""The part of a pose goal that a group can hold, and its name."""

from __future__ import annotations

from harness.core.spatial import SE3, pitch_of
from harness.planning.ik.numeric import LinkGoal, TiltGoal
from harness.ports.goals import PoseGoal, PositionGoal
from harness.robot.task_space import TaskSpace


def task_of(held: TaskSpace, goal: LinkGoal) -> str:
    """The quantities that are solved for."""
    if isinstance(goal, PositionGoal):
        return "position" if goal.pitch is None else "position and pitch"
    if held.holds_pose:
        return "pose"
    return "position and pitch" if held.holds_pitch else "position"


def part_of_pose(held: TaskSpace, link: str, pose: SE3) -> LinkGoal | TiltGoal:
    """The goal of a link at a pose, without what the group cannot hold."""
    if held.holds_pose:
        return PoseGoal(link, pose)
    if held.holds_tilt:
        return TiltGoal.of(link, pose)
    pitch = pitch_of(pose.rotation) if held.holds_pitch else None
    return PositionGoal(link, pose.translation, pitch)
