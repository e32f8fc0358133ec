import numpy as np
import pytest

from harness.core.trajectory import JointTrajectory
from harness.plugins.iktest.strategies.paths import JointPath


def test_a_paths_length_is_the_sum_of_its_segments():
    path = JointPath(("a", "b"), np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]]))
    assert path.length() == pytest.approx(6.0)


def test_a_trajectory_lasts_until_its_last_set_point():
    zeros = np.zeros((3, 1))
    trajectory = JointTrajectory(("a",), np.array([0.0, 0.5, 1.25]), zeros, zeros, zeros)
    assert trajectory.duration == 1.25
