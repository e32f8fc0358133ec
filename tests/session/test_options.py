"""Planning options: the step's words before the scenario's before the defaults, key by key."""

import math

import pytest

from harness.cell.program import step_seed
from harness.language.planning import Planning
from harness.session.options import check_planning, merged_options


def planning(words):
    """The key `planning`; `detour` is a pipeline that no installed package has."""
    words = dict(words)
    pipeline = words.pop("pipeline", None)
    return Planning(**words).model_copy(update={"pipeline": pipeline})


def merged(scenario=None, step=None, *, seed=3, path="steps[1]", rate=1000):
    return merged_options(
        planning(scenario or {}),
        None if step is None else planning(step),
        seed,
        path,
        rate,
        lambda pipeline, planner: f"{pipeline}:{planner}",
    )


def test_without_a_word_every_option_has_its_default():
    options = merged()
    assert (options.pipeline, options.planner_id) == ("ompl", "ompl:")
    assert (options.max_state_checks, options.attempts) == (2_000_000, 1)
    assert (options.velocity_scaling, options.acceleration_scaling) == (0.3, 0.3)
    assert (options.padding, options.max_jerk) == (0.002, math.inf)
    assert (options.root_seed, options.seed) == (3, step_seed(3, "steps[1]"))
    assert options.parameters == {}
    assert merged(step={}) == options


KEYS = {
    "planning_attempts": ("attempts", 4, 7),
    "max_velocity_scaling_factor": ("velocity_scaling", 0.1, 0.7),
    "max_acceleration_scaling_factor": ("acceleration_scaling", 0.1, 0.7),
    "padding": ("padding", 0.001, 0.004),
    "max_jerk": ("max_jerk", 5.0, 7.0),
    "seed": ("root_seed", 11, 12),
    "max_state_checks": ("max_state_checks", 50, 70),
}


@pytest.mark.parametrize("key", KEYS)
def test_a_word_of_the_step_goes_before_the_scenarios(key):
    option, low, high = KEYS[key]
    assert getattr(merged({key: low}), option) == low
    assert getattr(merged({key: low}, {}), option) == low
    assert getattr(merged({key: low}, {key: high}), option) == high
    assert getattr(merged({}, {key: high}), option) == high


def test_a_seed_is_that_of_the_step_in_the_file():
    assert (
        merged({"seed": 11}).seed
        == step_seed(11, "steps[1]")
        != merged({"seed": 11}, path="x").seed
    )


def test_a_budget_is_one_of_time_or_checks_and_the_steps_replaces_either():
    assert merged({"planning_time": 2.0}).max_state_checks == 2000
    assert merged({"planning_time": 0.0001}).max_state_checks == 1
    assert merged({"max_state_checks": 50}, {"planning_time": 0.3}).max_state_checks == 300
    assert merged({"planning_time": 2.0}, {"max_state_checks": 70}).max_state_checks == 70
    assert merged({"planning_time": 2.0}, {"padding": 0.0}).max_state_checks == 2000


def test_another_pipeline_has_its_own_planners():
    scenario = {"planner_id": "A", "parameters": {"range": 1.0}}
    assert merged(scenario, {}).planner_id == merged(scenario, {"pipeline": "ompl"}).planner_id
    assert merged(scenario, {}).planner_id == "ompl:A"
    assert merged(scenario, {}).parameters == {"range": 1.0}
    other = merged(scenario, {"pipeline": "detour"})
    assert (other.planner_id, other.parameters) == ("detour:", {})
    back = merged({**scenario, "pipeline": "detour"}, {"pipeline": "ompl"})
    assert (back.planner_id, back.parameters) == ("ompl:", {})


class Problems:
    def __init__(self):
        self.found = []

    def add(self, place, message, needs):
        assert needs == ()
        self.found.append((place, message))


def problems(own, scenario=None):
    """Problems with planners `ompl` A, which takes `range`, and `detour` B, which takes nothing."""

    def check(pipeline, planner, parameters):
        if (pipeline, planner) not in {
            ("ompl", "A"),
            ("ompl", ""),
            ("detour", "B"),
            ("detour", ""),
        }:
            raise ValueError(f"no {planner} in {pipeline}")
        for name in parameters:
            if (pipeline, name) != ("ompl", "range"):
                raise ValueError(f"no {name} of {planner}")

    report = Problems()
    others = None if scenario is None else planning(scenario)
    check_planning(planning(own), ("planning",), report, check, others)
    return report.found


def test_planners_and_parameters_that_do_not_exist_are_reported_where_they_stand():
    assert problems({}) == problems({"planner_id": "A", "parameters": {"range": 1.0}}) == []
    assert problems({"pipeline": "detour", "planner_id": "B"}) == []
    assert problems({"planner_id": "B"}) == [(("planning", "planner_id"), "no B in ompl")]
    place = ("planning", "parameters", "speed")
    assert problems({"parameters": {"range": 1.0, "speed": 2.0}}) == [(place, "no speed of ")]
    scenario = {"planner_id": "A", "parameters": {"range": 1.0}}
    assert problems({"pipeline": "detour"}, scenario) == []
    assert problems({"planner_id": "A"}, scenario) == []
    odd = {"pipeline": "detour", "planner_id": "B", "parameters": {"range": 1.0}}
    assert problems({"planner_id": "B"}, odd) == [(("planning", "planner_id"), "no range of B")]
    assert problems({}, {"planner_id": "B"}) == [], "the scenario's is reported at the scenario's"
    both = {"planning_time": 1.0, "max_state_checks": 5}
    [(place, message)] = problems(both)
    assert place == ("planning", "planning_time")
    assert "both" in message
    assert problems({"planning_time": 1.0}, {"max_state_checks": 5}) == []
