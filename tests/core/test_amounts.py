"""Positions of joints as people read them."""

import pytest

from harness.core.amounts import (
    JointUnits,
    amount_in_units,
    amounts,
    is_visible,
    joint_position,
    stated_amount,
)
from harness.language.goals import GoalFields

UNITS = JointUnits({"elbow": "rad", "wrist": "rad", "rail": "m", "lift": "m"}, gripper="m")


@pytest.mark.parametrize(
    ("positions", "text"),
    [
        ({"elbow": 0.3}, "17.19 deg"),
        ({"elbow": -1.5707963, "wrist": 0.0}, "(-90, 0) deg"),
        ({"rail": 1.25, "lift": 0.0004}, "(1250, 0.4) mm"),
        ({"rail": 0.02, "elbow": 3.14159265}, "20 mm, 180 deg"),
        ({"unknown": 0.5}, "0.5"),
    ],
)
def test_joint_positions_have_degrees_or_millimetres(positions, text):
    assert UNITS.text(positions) == text


def test_a_number_for_joints_of_both_kinds_has_both_units():
    assert amount_in_units(0.01, {"m", "rad"}) == "0.57 deg or 10.0 mm"
    assert amount_in_units(0.01, ()) == ""


def test_a_position_has_a_hundredth_of_a_degree():
    assert joint_position(-1e-9, "rad") == "0 deg"
    assert joint_position(0.00025, "m") == "0.25 mm"


def test_goals_are_summarised_in_the_units_of_the_robot():
    goal = GoalFields(joints={"rail": 0.3, "elbow": 1.0})
    assert goal.summary_in(UNITS) == "joints 300 mm, 57.3 deg"
    assert GoalFields(position={"xyz": [0.3, -0.2, 0.05]}).summary_in(UNITS) == "(300, -200, 50) mm"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (5e-7, "m", "0.00050 mm"),
        (0.02e-3, "m", "0.02 mm"),
        (1e-6, "rad", "5.7e-05 deg"),
        (0.0, "m", "0 mm"),
    ],
)
def test_a_limit_and_a_miss_have_digits_however_small_they_are(value, unit, text):
    assert stated_amount(value, unit) == text
    assert amount_in_units(value, (unit,)) == text
    assert amounts(0.3, value, unit)[1] == text


def test_a_difference_is_visible_where_it_is_not_written_as_0():
    assert is_visible(1e-5, "m")
    assert is_visible(-1e-5, "m")
    assert not is_visible(1e-9, "m")
    assert not is_visible(float("nan"), "m")
