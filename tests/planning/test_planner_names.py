"""Planner names as OMPL, MoveIt and people write them; all offered ones are deterministic."""

import numpy as np
import ompl.base
import ompl.geometric
import pytest

from harness.planning.checker import MotionChecker
from harness.planning.planner_names import planner_names, resolve_planner_id
from harness.planning.robot_model import GroupSpace
from harness.planning.search import search
from tests.planning.lesson import ARM, FIRST_BOXES, Cell, boxes, ur


@pytest.mark.parametrize(
    "name", ["RRTConnect", "RRTConnectkConfigDefault", "geometric::RRTConnect", "rrtconnect"]
)
def test_one_planner_has_the_names_of_ompl_and_moveit(name):
    assert resolve_planner_id(name) == "RRTConnect"


def test_unknown_planners_get_a_suggestion_and_the_list():
    with pytest.raises(ValueError, match=r"did you mean 'RRTConnect'\?.*KPIECE"):
        resolve_planner_id("RRTConect")


@pytest.mark.parametrize("name", ["PRM", "PRMstarkConfigDefault"])
def test_planners_with_threads_are_refused_with_the_reason(name):
    with pytest.raises(ValueError, match="two threads"):
        resolve_planner_id(name)


@pytest.mark.parametrize("name", ["chomp", "STOMP", "TrajOptkConfigDefault"])
def test_pipelines_of_moveit_are_refused_with_what_there_is_instead(name):
    with pytest.raises(ValueError, match=r"pipeline of MoveIt.*planners: auto, Balanced.*RRTCon"):
        resolve_planner_id(name)


def test_every_planner_of_the_ompl_wheel_is_offered_or_refused_with_a_reason():
    planners = {
        name
        for name in dir(ompl.geometric)
        if isinstance(getattr(ompl.geometric, name), type)
        and issubclass(getattr(ompl.geometric, name), ompl.base.Planner)
    }
    assert {"RRTConnect", "PRM", "FMT"} <= planners
    for name in planners:
        try:
            assert resolve_planner_id(name) == name
        except ValueError as refusal:
            assert "is refused" in str(refusal)  # noqa: PT017


@pytest.mark.parametrize("name", planner_names())
def test_every_planner_repeats_itself_inside_its_budget(name):
    cell = Cell(ur("ur3e"))
    cell.add(boxes(*FIRST_BOXES))
    cell.state = cell.with_arm(cell.named("mogi_down"))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    answers = []
    for _ in range(2):
        checker = MotionChecker(cell.scene, space, cell.state[:6], 0.0)
        found = search(
            name,
            checker,
            cell.state[:6],
            [cell.named("up")],
            resolution=1 / 16,
            max_state_checks=3000,
            seed=5,
            parameters={},
        )
        assert found.checks < 3000 + 500  # the edge at hand is finished
        path = b"" if found.waypoints is None else np.asarray(found.waypoints).tobytes()
        answers.append((found.checks, found.vertices, path))
    assert answers[0] == answers[1]


def test_an_unknown_parameter_is_refused_with_those_there_are():
    cell = Cell(ur("ur3e"))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    checker = MotionChecker(cell.scene, space, cell.state[:6], 0.0)
    with pytest.raises(ValueError, match=r"has no parameter 'rnage' .*range"):
        search(
            "RRTConnect",
            checker,
            cell.state[:6],
            [cell.named("up")],
            resolution=1 / 16,
            max_state_checks=10,
            seed=1,
            parameters={"rnage": 1.0},
        )
