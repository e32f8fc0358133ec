"""Poses of MoveIt's messages: rotations are normalised, and impossible numbers are refused."""

import numpy as np
import pytest

from harness.core.errors import StepFailed
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.moveit.values import pose_of


def pose(xyz=(0.0, 0.0, 0.0), wxyz=(1.0, 0.0, 0.0, 0.0)):
    x, y, z = xyz
    w, i, j, k = wxyz
    return message(
        "geometry_msgs/msg/Pose",
        position=message("geometry_msgs/msg/Point", x=x, y=y, z=z),
        orientation=message("geometry_msgs/msg/Quaternion", w=w, x=i, y=j, z=k),
    )


@pytest.mark.parametrize("wxyz", [(0.0, 0.0, 0.0, 0.0), (5e-324, 0.0, 0.0, 0.0), (0, 1e-200, 0, 0)])
def test_a_rotation_without_a_norm_is_none(wxyz):
    assert pose_of(pose((1.0, 2.0, 3.0), wxyz)).rotation == pytest.approx(np.eye(3))


@pytest.mark.parametrize(
    ("xyz", "wxyz"),
    [
        ((1e308, 0, 0), (1, 0, 0, 0)),
        ((0, 0, -1e10), (1, 0, 0, 0)),
        ((0, np.nan, 0), (1, 0, 0, 0)),
        ((0, 0, 0), (1e308, 1e308, 0, 0)),
        ((0, 0, 0), (np.inf, 0, 0, 0)),
    ],
)
def test_a_number_beyond_all_arms_is_refused(xyz, wxyz):
    with pytest.raises(StepFailed, match="not finite, or beyond 1e\\+09"):
        pose_of(pose(xyz, wxyz))
