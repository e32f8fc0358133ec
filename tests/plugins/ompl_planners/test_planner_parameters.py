"""Planners take their parameters by the names that OMPL and MoveIt's configurations write."""

import ompl.geometric
import pytest

from harness.plugins.ompl_planners.parameters import parameter_names, set_parameters
from harness.plugins.ompl_planners.sampling import make_problem
from tests.planning.planner_trial import Trial, signature


@pytest.fixture(scope="module")
def trial():
    return Trial()


MOVEIT = {
    "RRTConnect": {"range": 0.0},
    "RRT": {"range": 0.0, "goal_bias": 0.05},
    "RRTstar": {"range": 0.0, "goal_bias": 0.05, "delay_collision_checking": 1},
    "KPIECE": {
        "range": 0.0,
        "goal_bias": 0.05,
        "border_fraction": 0.9,
        "failed_expansion_score_factor": 0.5,
        "min_valid_path_fraction": 0.5,
    },
    "BKPIECE": {
        "range": 0.0,
        "border_fraction": 0.9,
        "failed_expansion_score_factor": 0.5,
        "min_valid_path_fraction": 0.5,
    },
    "LBKPIECE": {"range": 0.0, "border_fraction": 0.9, "min_valid_path_fraction": 0.5},
    "FMT": {
        "num_samples": 1000,
        "radius_multiplier": 1.1,
        "nearest_k": 1,
        "cache_cc": 1,
        "heuristics": 0,
        "extended_fmt": 1,
    },
    "BFMT": {
        "num_samples": 1000,
        "radius_multiplier": 1.0,
        "nearest_k": 1,
        "heuristics": 1,
        "cache_cc": 1,
        "extended_fmt": 1,
    },
    "PRM": {"max_nearest_neighbors": 10},
    "BITstar": {
        "rewire_factor": 1.1,
        "samples_per_batch": 100,
        "use_k_nearest": 1,
        "use_graph_pruning": 1,
        "prune_threshold_as_fractional_cost_change": 0.05,
        "use_just_in_time_sampling": 0,
        "drop_unconnected_samples_on_prune": 0,
        "stop_on_each_solution_improvement": 0,
        "find_approximate_solutions": 0,
    },
}
"""Parameters with OMPL's defaults, as configurations of MoveIt list them."""


@pytest.mark.parametrize("name", MOVEIT)
def test_a_planner_takes_the_parameters_that_moveit_lists(trial, name):
    assert trial.search(name, budget=300, **MOVEIT[name]).checks >= 300


@pytest.mark.parametrize(
    ("name", "parameter", "value", "getter"),
    [
        ("PRM", "max_nearest_neighbors", 7, "getMaxNearestNeighbors"),
        ("BITstar", "samples_per_batch", 20, "getSamplesPerBatch"),
        ("BITstar", "use_k_nearest", 0, "getUseKNearest"),
        ("BITstar", "use_graph_pruning", 0, "getPruning"),
        ("BITstar", "prune_threshold_as_fractional_cost_change", 0.2, "getPruneThresholdFraction"),
        ("BITstar", "drop_unconnected_samples_on_prune", 1, "getDropSamplesOnPrune"),
        ("RRTstar", "delay_collision_checking", 0, "getDelayCC"),
        ("RRTstar", "use_k_nearest", 0, "getKNearest"),
        ("KPIECE1", "failed_expansion_score_factor", 0.3, "getFailedExpansionCellScoreFactor"),
        ("FMT", "use_k_nearest", 0, "getNearestK"),
        ("FMT", "cache_cc", 0, "getCacheCC"),
    ],
)
def test_a_parameter_arrives(trial, name, parameter, value, getter):
    problem = make_problem(trial.request())
    planner = getattr(ompl.geometric, name)(problem.information)
    assert getattr(planner, getter)() != value
    set_parameters(planner, name, {parameter: value})
    assert getattr(planner, getter)() == value


@pytest.mark.parametrize(
    ("name", "parameter", "value"),
    [("PRM", "max_nearest_neighbors", 2), ("BITstar", "samples_per_batch", 20)],
)
def test_a_parameter_changes_the_search(trial, name, parameter, value):
    searches = [trial.search(name, seed) for seed in range(4)]
    others = [trial.search(name, seed, **{parameter: value}) for seed in range(4)]
    assert list(map(signature, searches)) != list(map(signature, others))


def test_an_unknown_parameter_is_refused_with_those_there_are(trial):
    with pytest.raises(ValueError, match=r"has no parameter 'rnage' .*range"):
        trial.search("RRTConnect", rnage=1.0)
    with pytest.raises(ValueError, match=r"PRM has no .*it has: max_nearest_neighbors\)"):
        trial.search("PRM", max_nearest_neighbours=5)


@pytest.mark.parametrize(
    ("name", "parameter", "value", "said"),
    [
        ("PRM", "max_nearest_neighbors", 0, "cannot be 0: 1 to 1000"),
        ("PRM", "max_nearest_neighbors", -3, "cannot be -3: 1 to 1000"),
        ("PRM", "max_nearest_neighbors", 2.5, "cannot be 2.5"),
        ("PRMstar", "max_nearest_neighbors", 5, "PRMstar refuses 'max_nearest_neighbors'"),
        ("BITstar", "samples_per_batch", 1e9, "cannot be 1e\\+09: 1 to 1000000"),
        ("BITstar", "use_k_nearest", 2, "cannot be 2"),
    ],
)
def test_values_that_a_planner_cannot_take_are_refused(trial, name, parameter, value, said):
    with pytest.raises(ValueError, match=said):
        trial.search(name, **{parameter: value})


def test_acronyms_have_the_spelling_of_ompl():
    assert {"cache_cc", "extended_fmt", "use_k_nearest"} <= set(parameter_names(ompl.geometric.FMT))
    assert "use_k_nearest" in parameter_names(ompl.geometric.BITstar)
