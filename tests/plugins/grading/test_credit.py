"""How much of its points an expectation earns that holds."""

from typing import get_args

import pytest

from harness.plugins.grading.assignment import IkExercise, PropertyName
from harness.plugins.grading.credit import credit_of_function, credit_of_run, property_verdicts
from harness.plugins.iktest.properties import BRANCHES, PROPERTIES


def row_of(name, tried=100, observed=100, flawed=0, findings=(), note=""):
    numbers = {"tried": tried, "observed": observed, "flawed": flawed}
    return {"name": name, "says": f"it {name}", **numbers, "findings": findings, "note": note}


def document(*properties, kinds=()):
    findings = [
        {"number": number, "kind": kind, "detail": "", "call": "ik(1)"}
        for number, kind in enumerate(kinds, 1)
    ]
    return {"properties": properties, "findings": findings}


@pytest.mark.parametrize(
    ("observed", "flawed", "share"), [(100, 0, 1.0), (100, 100, 0.0), (60, 20, 0.4), (0, 0, 0.0)]
)
def test_a_function_earns_the_share_of_targets_that_it_answers_rightly(observed, flawed, share):
    found = credit_of_function(document(row_of("reaches", observed=observed, flawed=flawed)))
    assert found.share == pytest.approx(share)
    assert bool(found.reason) == (share < 1)


def test_a_function_of_which_nothing_was_tried_earns_nothing():
    assert (
        credit_of_function(document(row_of("reaches", 0, 0, note="not tried: it hangs"))).share == 0
    )


def test_properties_are_worth_what_the_assignment_says():
    found = property_verdicts(
        document(
            row_of("reaches", flawed=3, findings=[1]),
            row_of("limits", observed=0),
            row_of("refuses"),
            kinds=["misses"],
        ),
        {"reaches": 4.0, "limits": 0.0},
    )
    assert [(each.status, each.points) for each in found] == [
        ("failed", 4.0),
        ("failed", 0.0),
        ("passed", 1.0),
    ]
    assert found[0].reason == "misses; in 3 of 100 cases, as ik(1)"
    assert found[1].reason == "no case showed it: the function misses"


def test_the_names_of_weights_are_those_of_the_properties():
    assert get_args(PropertyName) == tuple(each.name for each in (*PROPERTIES, BRANCHES))
    assert IkExercise(robot="ur3e", weights={"branches": 2}).weights == {"branches": 2}


@pytest.mark.parametrize(
    ("is_idle", "is_full", "share"),
    [(True, False, 0), (True, True, 1), (False, False, 1), (False, True, 1)],
)
def test_a_robot_that_stands_still_earns_nothing_unless_no_motion_was_required(
    is_idle, is_full, share
):
    assert credit_of_run(is_idle=is_idle, is_full=is_full).share == share
