"""The fast planner gets out of tight places, and samples the surroundings of what it knows."""

import numpy as np
import pytest

from harness.planning.model.robot_model import GroupSpace
from harness.planning.search.balanced_connect import (
    BEYOND,
    RANGE,
    _Samples,  # pyright: ignore[reportPrivateUsage]
    _Tree,  # pyright: ignore[reportPrivateUsage]
    search_connect,
)
from harness.ports.path_planning import PathRequest
from tests.planning.lesson import ARM, Cell, ur

WIDE = np.array([[-9.0], [9.0]])


def test_a_tree_in_a_narrow_bend_grows_by_shorter_steps_until_it_is_outside():
    tree = _Tree([np.zeros(2)], RANGE, np.tile(WIDE, 2))

    def in_the_bend(first, second):
        """Whether an edge stays in a corridor 0.2 wide, 1 along x and then 1 along y."""
        x, y = (first + np.linspace(0.0, 1.0, 200)[:, None] * (second - first)).T
        along_x = (np.abs(y) < 0.1) & (np.abs(x) < 1.1)
        along_y = (np.abs(x - 1.0) < 0.1) & (y > -0.1)
        return bool(np.all(along_x | along_y | (y > 1.0)))

    def extend(here, target, longest):
        way = target - here
        there = here + min(1.0, longest / np.linalg.norm(way)) * way
        return [there] if in_the_bend(here, there) else []

    rng = np.random.default_rng(1)
    for _ in range(2000):
        angle = rng.uniform(0.0, 2 * np.pi)
        sample = 4.0 * np.array([np.cos(angle), np.sin(angle)])
        tree.grow(sample, extend)
    assert tree.points[: tree.count, 1].max() > 2.0


def test_samples_are_drawn_about_the_tree_and_inside_the_limits():
    limits = np.array([[-1.5, -1.5], [4.0, 3.0]])
    tree, samples = _Tree([np.zeros(2), np.array([1.0, 1.2])], RANGE, limits), _Samples(2, 1)
    drawn = np.array([tree.draw(samples) for _ in range(400)])
    assert np.allclose(drawn.min(axis=0), [-BEYOND, -BEYOND], atol=0.05)
    assert np.allclose(drawn.max(axis=0), [1.0 + BEYOND, 1.2 + BEYOND], atol=0.05)
    for sample in ([2.4, 1.2], [1.0, 2.6], [-1.0, -1.0]):
        assert tree.grow(np.array(sample), lambda _, target, __: [target]) is not None
    drawn = np.array([tree.draw(samples) for _ in range(400)])
    assert np.allclose(drawn.min(axis=0), limits[0], atol=0.05)
    assert np.allclose(drawn.max(axis=0), [2.4 + BEYOND, 3.0], atol=0.05)


@pytest.mark.parametrize("seed", [1, 2, 1_000_000])
def test_no_sample_is_used_twice_and_every_other_one_is_near_a_vertex(seed):
    samples, ends = _Samples(7, seed), [np.zeros(7), np.full(7, 8.0)]
    tree = _Tree(ends, RANGE, np.tile(WIDE, 7))
    drawn = np.array([tree.draw(samples) for _ in range(200)])
    assert len(np.unique(drawn, axis=0)) == 200
    near = [np.abs(drawn - end).max(axis=1) <= BEYOND for end in ends]
    for number, each in enumerate(near):
        assert 40 <= each[1::2].sum() <= 60, f"the samples about vertex {number}"
    assert (near[0] | near[1])[1::2].all()
    assert (near[0] | near[1])[::2].sum() < 10


@pytest.mark.parametrize("budget", [10_000, 200_000, 1_000_000])
@pytest.mark.parametrize("closed", [0, 1])
def test_a_search_from_or_to_a_closed_place_gives_up_before_its_budget_is_used(closed, budget):
    """With a larger budget it tries for longer."""
    cell = Cell(ur("ur5e"))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    ends = np.array([[0.0, -1.0, 0.5, 0.0, 0.0, 0.0], [2.0, -1.5, 1.0, 0.5, 0.0, 0.0]])
    used = 0

    def is_edge_free(first, second):
        nonlocal used
        used += max(1, int(np.ceil(space.distance(first, second) * 32)))
        return not any(np.array_equal(ends[closed], end) for end in (first, second))

    request = PathRequest(
        planner_id="BalancedConnect",
        space=space,
        start=ends[0],
        goals=(ends[1],),
        is_state_free=lambda _: True,
        is_edge_free=is_edge_free,
        state_checks=lambda: used,
        max_state_checks=budget,
        resolution=1 / 32,
        seed=1,
        parameters={},
    )
    assert search_connect(request).waypoints is None
    assert 0.002 * budget < used < max(3_000, 0.1 * budget)
