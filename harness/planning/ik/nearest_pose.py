"""The pose nearest to a goal that cannot be reached, and the one nearest to a goal in collision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.planning.ik.numeric import LinkGoal, LinkTask, starts
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal, PositionGoal

RESTARTS = 12  # Number of searches from the pose table, in addition to the one from the seed
EVEN, KEEP_TURN, KEEP_POINT = 0.1, 100.0, 1e-3
"""Metres that a radian counts: as a hand's breadth, above all, nearly nothing."""

REACHED = 1e-5  # [m, rad] A goal that is missed by less is reached
SHIFTS = (0.01, 0.02, 0.04, 0.08, 0.16)
"""How far a goal in collision is moved in search of a free place [m]."""

_SHORTEST_SHIFT = 0.001  # [m] how finely the way to the free place is halved


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


def nearest_free_shift(
    goal: LinkGoal, solve: Callable[[LinkGoal], Sequence[FloatArray]], is_free: Callable[..., bool]
) -> tuple[FloatArray, FloatArray] | None:
    """The shortest move of a goal, along a world axis or away, that frees it.

    Args:
        goal: The goal, in collision in each of its solutions.

    Returns:
        The move [m], shape (3,), and free group positions there; None when no place within the
        longest of `SHIFTS` is free.
    """

    def free_at(shift: FloatArray) -> FloatArray | None:
        return next((q for q in solve(_moved(goal, shift)) if is_free(q)), None)

    directions = np.array(
        [(0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1)], dtype=float
    )
    for number, far in enumerate(SHIFTS):
        near = SHIFTS[number - 1] if number else 0.0
        found = [(axis, free_at(far * axis)) for axis in directions]
        free = [(axis, positions) for axis, positions in found if positions is not None]
        if free:
            ways = [_halved(axis, positions, near, far, free_at) for axis, positions in free]
            return min(ways, key=lambda way: round(float(np.linalg.norm(way[0])), 6))
    return None


def _halved(
    axis: FloatArray,
    positions: FloatArray,
    near: float,
    far: float,
    free_at: Callable[[FloatArray], FloatArray | None],
) -> tuple[FloatArray, FloatArray]:
    """The shortest free move along an axis between one that is not and one that is."""
    while far - near > _SHORTEST_SHIFT:
        middle = 0.5 * (near + far)
        found = free_at(middle * axis)
        if found is None:
            near = middle
        else:
            far, positions = middle, found
    return far * axis, positions


def _moved(goal: LinkGoal, shift: FloatArray) -> LinkGoal:
    if isinstance(goal, PositionGoal):
        return replace(goal, position=goal.position + shift)
    return replace(goal, pose=SE3(goal.pose.rotation, goal.pose.translation + shift))
