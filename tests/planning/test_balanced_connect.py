"""The fast planner gets out of tight places, and samples every way that an arm can stand."""

import numpy as np

from harness.planning.model.robot_model import GroupSpace
from harness.planning.search.balanced_connect import (
    RANGE,
    _Tree,  # pyright: ignore[reportPrivateUsage]
    sampling_bounds,
)
from tests.planning.lesson import ARM, Cell, ur


def test_a_tree_in_a_narrow_bend_grows_by_shorter_steps_until_it_is_outside():
    tree = _Tree([np.zeros(2)], RANGE)

    def in_the_bend(first, second):
        """Whether an edge stays in a corridor 0.2 wide, 1 along x and then 1 along y."""
        x, y = (first + np.linspace(0.0, 1.0, 200)[:, None] * (second - first)).T
        along_x = (np.abs(y) < 0.1) & (np.abs(x) < 1.1)
        along_y = (np.abs(x - 1.0) < 0.1) & (y > -0.1)
        return bool(np.all(along_x | along_y | (y > 1.0)))

    rng = np.random.default_rng(1)
    for _ in range(2000):
        angle = rng.uniform(0.0, 2 * np.pi)
        sample = 4.0 * np.array([np.cos(angle), np.sin(angle)])
        near, distance = tree.nearest(sample)
        tree.grow(near, sample, distance, in_the_bend)
    assert tree.points[: tree.count, 1].max() > 2.0


def test_samples_are_drawn_inside_the_limits_and_half_a_turn_about_start_and_goal():
    cell = Cell(ur("ur5e"))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    ends = np.array([[0.5] * 6, [-0.5] * 6])
    lower, upper = sampling_bounds(space, ends)
    assert np.all(lower >= space.lower)
    assert np.all(upper <= space.upper)
    assert np.allclose(lower, np.maximum(space.lower, -0.5 - np.pi))
    assert np.allclose(upper, np.minimum(space.upper, 0.5 + np.pi))
