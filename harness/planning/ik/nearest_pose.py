"""The pose nearest to a goal that cannot be reached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.planning.ik.numeric import LinkGoal, LinkTask, starts
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal

RESTARTS = 12  # Number of searches from the pose table, in addition to the one from the seed
EVEN, KEEP_TURN, KEEP_POINT = 0.1, 100.0, 1e-3
"""Metres that a radian counts: as a hand's breadth, above all, nearly nothing."""

REACHED = 1e-5  # [m, rad] A goal that is missed by less is reached


@dataclass(frozen=True, eq=False)
class NearestPose:
    """Where a link comes nearest to its goal.

    Attributes:
        pose: The pose T_world_link at these positions.
        shift: Distance to the goal's point [m].
        turn: The rotation from the goal's orientation, or its pitch [rad]; 0 for a point alone.
    """

    positions: FloatArray
    pose: SE3
    shift: float
    turn: float

    @property
    def is_reached(self) -> bool:
        """Whether that is the goal itself."""
        return self.shift < REACHED and self.turn < REACHED


def target_of(goal: LinkGoal) -> FloatArray:
    """The goal's point in the world, shape (3,)."""
    target = goal.pose.translation if isinstance(goal, PoseGoal) else goal.position
    return np.asarray(target, dtype=float)


def distance_to_goal(goal: LinkGoal, pose: SE3) -> tuple[float, float]:
    """How far a link's pose is from a goal: [m], and [rad] of what the goal says of its turn."""
    if isinstance(goal, PoseGoal):
        return goal.pose.distance_to(pose)
    shift = float(np.linalg.norm(goal.position - pose.translation))
    if goal.pitch is None:
        return shift, 0.0
    pitch = float(np.arcsin(np.clip(np.sin(goal.pitch), -1.0, 1.0)))
    return shift, abs(pitch_of(pose.rotation) - pitch)


def nearest_pose(
    space: GroupSpace,
    goal: LinkGoal,
    seed_positions: FloatArray,
    *,
    metres_per_radian: float = EVEN,
) -> NearestPose:
    """The pose inside the joint limits that comes nearest to a goal; collisions are ignored.

    Damped least squares from the seed and from near the goal: what it says can be reached is
    reached; that nothing is nearer is not proved.

    Args:
        metres_per_radian: What a turn counts: `EVEN`, `KEEP_TURN` or `KEEP_POINT`.
    """
    task = LinkTask(space, goal, metres_per_radian=metres_per_radian)
    attempts = [
        task.least_squares(start) for start in starts(space, goal, seed_positions, RESTARTS)
    ]
    best = min(range(len(attempts)), key=lambda index: (round(attempts[index][1], 9), index))
    positions = attempts[best][0]
    pose = task.link_pose(positions)
    return NearestPose(positions, pose, *distance_to_goal(goal, pose))
