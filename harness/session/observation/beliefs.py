"""Poses of the objects that only the planner knows, sample by sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.cell.scene_state import Belief
from harness.core.pose_arrays import compose
from harness.core.types import FloatArray
from harness.ports.kinematics import Kinematics


def believed_poses(
    beliefs: Mapping[str, Sequence[Belief]], joint_positions: FloatArray, kinematics: Kinematics
) -> dict[str, FloatArray]:
    """T_world_object of every sample, NaN while absent, shape (N, 7) each.

    Args:
        beliefs: The beliefs of each object, in order of time.
        joint_positions: Recorded, description order, shape (N, n).
    """
    count = len(joint_positions)
    poses: dict[str, FloatArray] = {}
    for name, changes in beliefs.items():
        rows = np.full((count, 7), np.nan)
        for change in changes:  # a later one overwrites
            if change.pose is None:
                rows[change.sample :] = np.nan
            elif not change.link:
                rows[change.sample :] = change.pose.as_vector()
            else:
                carrier = kinematics.link_poses(joint_positions[change.sample :], [change.link])
                rows[change.sample :] = compose(carrier[:, 0], change.pose.as_vector())
        poses[name] = rows
    return poses
