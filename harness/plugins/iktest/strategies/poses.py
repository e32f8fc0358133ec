"""Poses of a link: reachable by construction, unreachable by construction, or either."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.positions import (
    Positions,
    joint_positions,
    near_limit_positions,
    near_singular_positions,
)
from harness.plugins.iktest.strategies.tasks import Task


@dataclass(frozen=True, eq=False)
class Target:
    """A target pose.

    Attributes:
        joint_positions: Joint positions that reach the pose, shape (dof,); None when unknown.
    """

    pose: SE3
    joint_positions: FloatArray | None = None


Targets = st.SearchStrategy[Target]

BEYOND = (0.001, 0.01, 0.1, 1.0)  # distances outside the arm's reach, as shares of the reach


def reachable_poses(chain: Chain, positions: Positions | None = None) -> Targets:
    """Poses that the arm can take: forward kinematics of joint positions within the limits.

    Args:
        positions: Joint positions to draw from; by default anywhere between the limits.
    """
    drawn = joint_positions(chain) if positions is None else positions
    return drawn.map(lambda each: Target(chain.link_pose(each), each))


def near_limit_poses(chain: Chain) -> Targets:
    """Poses that the arm takes with a joint at a limit or next to it."""
    return reachable_poses(chain, near_limit_positions(chain))


def near_singular_poses(chain: Chain, task: Task | None = None) -> Targets:
    """Poses that the arm takes at a singularity or next to it."""
    return reachable_poses(chain, near_singular_positions(chain, task))


def unreachable_poses(chain: Chain, *, any_orientation: bool = False) -> Targets:
    """Poses that no joint positions reach, whatever the limits: the arm is too short.

    Args:
        any_orientation: Whether the position is unreachable in every orientation; else the pose
            puts the last joint out of reach.
    """
    centre, radius = chain.farthest()
    tip_length = np.linalg.norm(chain.tip.translation) if any_orientation else 0.0
    reach = radius + float(tip_length)

    def beyond(target: Target, share: float) -> Target:
        pose = target.pose
        last = pose @ chain.tip.inverse()
        here = pose.translation if any_orientation else last.translation
        away = here - centre
        length = float(np.linalg.norm(away))
        direction = away / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])
        shift = centre + direction * reach * (1.0 + share) - here
        return Target(SE3(pose.rotation, pose.translation + shift))

    return st.builds(beyond, reachable_poses(chain), st.sampled_from(BEYOND))


def poses_around(chain: Chain) -> Targets:
    """Poses anywhere in and around the arm's reach: a reachable one, moved by up to its reach.

    Whether the arm can reach them is unknown.
    """
    size = chain.farthest()[1] + float(np.linalg.norm(chain.tip.translation))
    shares = st.integers(-100, 100).map(lambda percent: 0.01 * percent)

    def moved(target: Target, share: tuple[float, float, float]) -> Target:
        shift = np.round(size * np.array(share), 3)
        if not shift.any():
            return target
        return Target(SE3(target.pose.rotation, target.pose.translation + shift))

    return st.builds(moved, reachable_poses(chain), st.tuples(shares, shares, shares))
