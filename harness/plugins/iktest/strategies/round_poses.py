"""Poses at round values: on planes and axes of the arm, at even coordinates, level or upright."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from hypothesis import strategies as st

from harness.core.pose_arrays import rotations_about
from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.poses import Target, Targets, poses_around
from harness.plugins.iktest.strategies.positions import joint_positions
from harness.plugins.iktest.strategies.tasks import (
    Task,
    miss,
    natural_task,
    task_error,
    task_jacobians,
)

STEP = 0.01  # coordinates that are multiples of this count as even [m]

UP = np.array([0.0, 0.0, 1.0])
PITCH_STEP = np.pi / 4
EXACT = 1e-9  # [m, rad], within which positions reach a pose: far below every tolerance


@dataclass(frozen=True)
class Rounding:
    """What of a pose is rounded.

    Attributes:
        heading: Quarter turns about the pivot's vertical from +x at which the pose is; -1 for its
            own heading.
        is_even: Whether x and y are even, where the heading leaves them open.
        height: Whether z is as it is, even, 0, or the pivot's.
        is_turned: Whether the orientation, or the pitch, is rounded.
    """

    heading: int
    is_even: bool
    height: Literal["own", "even", "zero", "pivot"]
    is_turned: bool


ROUNDINGS = st.builds(
    Rounding,
    st.integers(-1, 3),
    st.booleans(),
    st.sampled_from(["own", "even", "zero", "pivot"]),
    st.booleans(),
)


def round_poses_around(chain: Chain, task: Task | None = None) -> Targets:
    """Poses at round values anywhere in and around the arm's reach.

    They are exactly straight ahead of the arm's pivot (the first joint's axis at the height of the
    shoulder), to a side of it or on its far side, or at even coordinates; their axes are along
    those of the world, or their pitch is even. Whether the arm can reach them is unknown.

    Args:
        task: The task of the arm; by default `natural_task`.
    """
    fixed = task or natural_task(chain)
    return st.builds(
        lambda target, rounding: Target(_rounded(chain, fixed, target.pose, rounding)),
        poses_around(chain),
        ROUNDINGS,
    )


def round_reachable_poses(chain: Chain, task: Task | None = None) -> Targets:
    """Poses at round values as of `round_poses_around` that the arm can take, with positions.

    Those near to a reachable pose are reached by Newton's method; where it does not converge
    within the limits, the reachable pose is the target as it is.
    """
    fixed = task or natural_task(chain)

    def target(positions: FloatArray, rounding: Rounding) -> Target:
        own = chain.link_pose(positions)
        pose, turn = _turned_and_rounded(chain, fixed, own, rounding)
        for way in dict.fromkeys(
            (turn, -turn)
        ):  # the first joint may turn either way about the vertical
            turned = positions.copy()
            turned[0] += np.arctan2(np.sin(way), np.cos(way))
            reaching = _reaching(chain, fixed, pose, turned)
            if reaching is not None:
                return Target(pose, reaching)
        return Target(own, positions)

    return st.builds(target, joint_positions(chain), ROUNDINGS)


def _reaching(chain: Chain, task: Task, pose: SE3, start: FloatArray) -> FloatArray | None:
    """Positions within the limits that reach a pose, from those near to it; None if not found."""
    reach, found, last = max(chain.farthest()[1], 1e-6), start, np.inf
    while True:
        here = chain.link_pose(found)
        error = task_error(task, pose, here, reach)
        size = float(np.linalg.norm(error))
        if max(miss(task, pose, here)) < EXACT:
            inside = np.all((found >= chain.lower) & (found <= chain.upper))
            return found if inside else None
        if not size < last:
            return None
        last = size
        jacobian = task_jacobians(chain, task, found[None])[0]
        found = found + np.linalg.lstsq(jacobian, error, rcond=None)[0]


def _rounded(chain: Chain, task: Task, pose: SE3, rounding: Rounding) -> SE3:
    """A pose at round values, turned about the vertical to its heading."""
    return _turned_and_rounded(chain, task, pose, rounding)[0]


def _turned_and_rounded(
    chain: Chain, task: Task, pose: SE3, rounding: Rounding
) -> tuple[SE3, float]:
    """A pose at round values, and how far it was turned about the vertical [rad]."""
    pivot, place, turn = chain.farthest()[0], pose.translation.copy(), 0.0
    even = STEP * np.round(place / STEP)
    if rounding.heading >= 0:
        away = place[:2] - pivot[:2]
        along, across = (0, 1) if rounding.heading % 2 == 0 else (1, 0)
        turn = rounding.heading * np.pi / 2 - float(np.arctan2(away[1], away[0]))
        side = 1.0 if rounding.heading < 2 else -1.0
        place[along] = pivot[along] + side * float(np.hypot(*away))
        place[across] = pivot[across]
        if rounding.is_even:
            place[along] = STEP * round(place[along] / STEP)
    elif rounding.is_even:
        place[:2] = even[:2]
    heights = {"own": place[2], "even": even[2], "zero": 0.0, "pivot": pivot[2]}
    place[2] = heights[rounding.height]
    rotation = rotations_about(UP, turn) @ pose.rotation
    if rounding.is_turned and task == "pose":
        rotation = _along_axes(rotation)
    elif rounding.is_turned:
        rotation = _headed(rotation, PITCH_STEP * round(pitch_of(rotation) / PITCH_STEP))
    return SE3(rotation, place), turn


def _along_axes(rotation: FloatArray) -> FloatArray:
    """The rotation near another one whose axes are those of the world."""
    found = np.zeros((3, 3))
    first, second = (int(np.abs(rotation[:, axis]).argmax()) for axis in (0, 1))
    if second == first:
        second = int(np.abs(np.where(np.arange(3) == first, 0.0, rotation[:, 1])).argmax())
    found[first, 0] = np.sign(rotation[first, 0])
    found[second, 1] = np.sign(rotation[second, 1]) or 1.0
    found[:, 2] = np.cross(found[:, 0], found[:, 1])
    return found


def _headed(rotation: FloatArray, pitch: float) -> FloatArray:
    """The rotation with the heading of another one's x axis and a pitch [rad]."""
    heading = np.arctan2(rotation[1, 0], rotation[0, 0])
    about_z = rotations_about(UP, heading)
    return about_z @ rotations_about(np.array([0.0, 1.0, 0.0]), pitch)
