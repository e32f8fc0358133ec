"""What an arm with some number of joints can reach."""

from __future__ import annotations

from harness.ports.goals import PoseGoal, PositionGoal

WHOLE_POSE_JOINTS, TILT_JOINTS, PITCH_JOINTS = 6, 5, 4
"""Joints that an arm needs for an arbitrary pose; for one up to a turn about the vertical; and for
an arbitrary position and pitch."""


def task_of(dof: int, goal: PoseGoal | PositionGoal) -> str:
    """The quantities that are solved for; fewer than six joints cannot reach every pose."""
    if isinstance(goal, PositionGoal):
        return "position" if goal.pitch is None else "position and pitch"
    if dof >= WHOLE_POSE_JOINTS:
        return "pose"
    return "position and pitch" if dof >= PITCH_JOINTS else "position"
