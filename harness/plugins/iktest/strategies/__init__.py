"""Hypothesis strategies for robot arms; counterexamples shrink towards the home state.

Poses result from forward kinematics and are never filtered, so no draw is discarded.
"""

from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.paths import StraightLine, joint_paths, straight_lines
from harness.plugins.iktest.strategies.poses import (
    Target,
    near_limit_poses,
    near_singular_poses,
    poses_around,
    reachable_poses,
    unreachable_poses,
)
from harness.plugins.iktest.strategies.positions import (
    joint_positions,
    load_chain,
    near_limit_positions,
    near_singular_positions,
)
from harness.plugins.iktest.strategies.scenarios import scenarios

__all__ = [
    "Chain",
    "StraightLine",
    "Target",
    "joint_paths",
    "joint_positions",
    "load_chain",
    "near_limit_poses",
    "near_limit_positions",
    "near_singular_poses",
    "near_singular_positions",
    "poses_around",
    "reachable_poses",
    "scenarios",
    "straight_lines",
    "unreachable_poses",
]
