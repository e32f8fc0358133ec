"""Roadmaps are grown by OMPL in state checks; the way through them is the shortest there is."""

from itertools import pairwise

import numpy as np
import pytest

from harness.plugins.ompl_planners.sampling import IMPROVING_SHARE
from tests.planning.planner_trial import RESOLUTION, Trial


@pytest.fixture(scope="module")
def trial():
    return Trial()


def length(found):
    return np.linalg.norm(np.diff(found.waypoints, axis=0), axis=1).sum()


@pytest.mark.parametrize("name", ["PRM", "PRMstar", "BITstar"])
def test_a_way_leads_from_the_start_to_the_goal_along_free_edges(trial, name):
    solved = 0
    for seed in range(6):
        way = trial.search(name, seed).waypoints
        if way is None:
            continue
        solved += 1
        assert np.array_equal(way[[0, -1]], [trial.start, trial.goal])
        checker = trial.checker()
        assert all(checker.edge_free(*edge, RESOLUTION) for edge in pairwise(way))
    assert solved >= 4


@pytest.mark.nightly(but=["PRMstar"])
@pytest.mark.parametrize("name", ["PRMstar", "BITstar"])
def test_a_planner_that_improves_its_way_uses_its_share_and_finds_shorter_ones(trial, name):
    budgets = (200_000, 1_600_000)
    quick, thorough = (
        [trial.search(name, seed, budget) for seed in range(3)] for budget in budgets
    )
    for found, budget in zip((*quick, *thorough), np.repeat(budgets, 3), strict=True):
        share = IMPROVING_SHARE * budget
        assert share <= found.checks < 1.5 * share  # the milestone at hand is joined to its nearest
    assert np.mean([length(found) for found in thorough]) < np.mean([length(f) for f in quick])


def test_prm_stops_when_it_has_a_way(trial):
    assert all(trial.search("PRM", seed, 20_000).checks < 8_000 for seed in range(4))


def test_a_roadmap_leads_to_the_goal_that_is_nearest_along_it(trial):
    near = trial.start + 0.05
    found = trial.search("PRMstar", goals=[trial.goal, near])
    assert np.array_equal(found.waypoints, [trial.start, near])


def test_a_roadmap_in_parts_reports_how_far_they_are_apart(trial):
    apart = np.linalg.norm(trial.goal - trial.start)
    gaps = [trial.search("PRM", seed, 300).gap for seed in range(6)]
    assert all(0.1 < gap <= apart + 1e-9 for gap in gaps)
    assert min(gaps) < apart
