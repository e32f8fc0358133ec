"""Planner names as OMPL, MoveIt and people write them; all offered ones are deterministic."""

import json
import os
import subprocess
import sys

import numpy as np
import ompl.base
import ompl.geometric
import pytest

from harness.planning.search.planner_names import planner_names, resolve_planner_id
from tests.planning.planner_trial import Trial, signature
from tests.waiting import HANG


@pytest.fixture(scope="module")
def trial():
    return Trial()


@pytest.mark.parametrize(
    "name", ["RRTConnect", "RRTConnectkConfigDefault", "geometric::RRTConnect", "rrtconnect"]
)
def test_one_planner_has_the_names_of_ompl_and_moveit(name):
    assert resolve_planner_id(name) == "RRTConnect"


def test_unknown_planners_get_a_suggestion_and_the_list():
    with pytest.raises(ValueError, match=r"did you mean `RRTConnect`\?.*KPIECE"):
        resolve_planner_id("RRTConect")


def test_planners_with_threads_are_refused_with_the_reason():
    with pytest.raises(ValueError, match="several threads"):
        resolve_planner_id("AnytimePathShortening")


@pytest.mark.parametrize("name", ["chomp", "STOMP", "TrajOptkConfigDefault"])
def test_pipelines_of_moveit_are_refused_with_what_there_is_instead(name):
    with pytest.raises(ValueError, match=r"pipeline of MoveIt.*planners: auto, Balanced.*RRTCon"):
        resolve_planner_id(name)


def test_every_planner_of_the_ompl_wheel_is_offered():
    planners = {
        name
        for name in dir(ompl.geometric)
        if isinstance(getattr(ompl.geometric, name), type)
        and issubclass(getattr(ompl.geometric, name), ompl.base.Planner)
    }
    assert {"RRTConnect", "PRM", "BITstar"} <= planners
    assert {resolve_planner_id(name) for name in planners} == planners


@pytest.mark.nightly(but=["auto"])
@pytest.mark.parametrize("name", planner_names())
def test_every_planner_repeats_itself_inside_its_budget(trial, name):
    first, second = trial.search(name), trial.search(name)
    assert signature(first) == signature(second)
    assert first.checks < 3000 + 500  # the edge at hand is finished


@pytest.mark.nightly
def test_every_planner_repeats_itself_in_a_fresh_process(trial):
    """Of another hash seed; the budget is what each of them mostly needs."""
    here = {name: list(signature(trial.search(name, seed=8))) for name in planner_names()}
    assert sum(path != "" for *_, path in here.values()) >= 8
    code = (
        "import json; from harness.planning.search.planner_names import planner_names;"
        "from tests.planning.planner_trial import Trial, signature; trial = Trial();"
        "print(json.dumps({n: signature(trial.search(n, seed=8)) for n in planner_names()}))"
    )
    assert json.loads(_fresh_process(code)) == here


@pytest.mark.parametrize("budget", [1, 2, 74, 150])
@pytest.mark.parametrize("name", planner_names())
def test_a_budget_that_is_too_small_ends_every_planner_and_reports_what_is_left(
    trial, name, budget
):
    found = trial.search(name, budget=budget)
    assert found.waypoints is None
    assert found.checks < budget + 500
    assert 0.5 < found.gap <= np.linalg.norm(trial.goal - trial.start) + 1e-9


@pytest.mark.parametrize("name", planner_names())
def test_no_planner_looks_for_a_way_to_where_the_arm_stands(trial, name):
    found = trial.search(name, goals=[trial.start.copy()])
    assert np.array_equal(found.waypoints, [trial.start, trial.start])


@pytest.mark.nightly
def test_plans_are_freed():
    """A plan that OMPL keeps for good keeps its checker too: 5 MB each."""
    code = (
        "import json; from tests.planning.planner_memory import memory_kept_by_plans;"
        "print(json.dumps(memory_kept_by_plans()))"
    )
    kept = json.loads(_fresh_process(code))
    assert kept.keys() == {*planner_names()}
    assert {name: grown for name, grown in kept.items() if grown > 1.2} == {}  # [MB]


def _fresh_process(code: str) -> str:
    """What another process prints, of another hash seed."""
    environment = {**os.environ, "PYTHONHASHSEED": "123"}
    command = [sys.executable, "-c", code]
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=HANG, check=True
    ).stdout
