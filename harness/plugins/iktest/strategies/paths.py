"""Joint paths, and straight lines that the arm can follow."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from hypothesis import strategies as st

from harness.core.spatial import SE3
from harness.core.trajectory import path_length
from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.positions import Positions, joint_positions
from harness.plugins.iktest.strategies.tasks import (
    Task,
    manipulability,
    natural_task,
    task_error,
    task_jacobians,
)

_CORNERS = np.array(list(product((1.0, -1.0), repeat=3))) / np.sqrt(3.0)
DIRECTIONS: FloatArray = np.concatenate([np.eye(3), -np.eye(3), _CORNERS])
"""Unit vectors along the axes of the world and along its space diagonals, shape (14, 3)."""

STEP = 0.002  # [m] between points of a line
MARGIN = 0.02  # share of the ranges that lines keep from the limits
LARGEST_STEP = 0.1  # [rad or m] of a joint from point to point
CONVERGED = 1e-7  # largest task error of a point on a line, lengths as shares of the reach
LEAST_MANIPULABILITY = 0.02  # where lines end before a singularity


@dataclass(frozen=True, eq=False)
class JointPath:
    """Waypoints joined by straight joint-space segments, without time.

    Attributes:
        joint_names: The planning group's joints, in order.
        waypoints: The joint positions, shape (N, dof), rad or m.
    """

    joint_names: tuple[str, ...]
    waypoints: FloatArray

    def length(self) -> float:
        """Sum of the segments' joint-space L2 norms [rad]."""
        return path_length(self.waypoints)


@dataclass(frozen=True, eq=False)
class StraightLine:
    """A straight line of the link, with joint positions that follow it without a jump.

    Attributes:
        joint_positions: The joint positions, shape (N, dof), N >= 1.
        direction: Unit vector in the world, shape (3,).
    """

    joint_positions: FloatArray
    direction: FloatArray


def joint_paths(
    chain: Chain, *, min_size: int = 2, max_size: int = 5
) -> st.SearchStrategy[JointPath]:
    """Paths through joint positions anywhere between the limits."""
    waypoints = st.lists(joint_positions(chain), min_size=min_size, max_size=max_size)
    return waypoints.map(lambda each: JointPath(chain.joint_names, np.array(each)))


def straight_lines(
    chain: Chain,
    task: Task | None = None,
    *,
    positions: Positions | None = None,
    max_length: float = 0.1,
) -> st.SearchStrategy[StraightLine]:
    """Straight lines of the link that keep what the task fixes of its orientation.

    A line starts at joint positions and ends close to a limit or a singularity, so that a
    continuous joint path along it always exists. A line may be a single point.

    Args:
        task: The arm's task; by default `natural_task`.
        positions: Start positions; by default anywhere between the limits.
        max_length: Largest length of a line [m].
    """
    fixed = task or natural_task(chain)
    starts = joint_positions(chain, margin=MARGIN) if positions is None else positions
    counts = st.integers(1, max(1, round(max_length / STEP)))
    return st.builds(
        lambda start, direction, count: _follow(chain, fixed, start, direction, count),
        starts,
        st.sampled_from(list(DIRECTIONS)),
        counts,
    )


def _follow(
    chain: Chain, task: Task, start: FloatArray, direction: FloatArray, count: int
) -> StraightLine:
    """Walk along a direction by differential kinematics, corrected at every point."""
    positions = np.array(start)
    middle = 0.5 * (chain.upper + chain.lower)
    half = 0.5 * (1.0 - MARGIN) * (chain.upper - chain.lower)
    reach = max(chain.farthest()[1], 1e-6)
    origin = chain.link_pose(positions)
    walked = [positions]
    for number in range(1, count + 1):
        if manipulability(chain, task, positions[None])[0] < LEAST_MANIPULABILITY:
            break
        goal = SE3(origin.rotation, origin.translation + number * STEP * direction)
        for _ in range(3):
            rows = task_jacobians(chain, task, positions[None])[0]
            change = task_error(task, goal, chain.link_pose(positions), reach)
            positions = positions + np.linalg.lstsq(rows, change, rcond=None)[0]
        if np.abs(task_error(task, goal, chain.link_pose(positions), reach)).max() > CONVERGED:
            break
        if np.any(np.abs(positions - middle) > half):
            break
        if np.abs(positions - walked[-1]).max() > LARGEST_STEP:
            break
        walked.append(positions)
    return StraightLine(np.array(walked), direction)
