"""Typed records of failures: what run.json says of them, and that they are read back from it."""

import json

import pytest

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.recording.explanation import (
    Explanation,
    FreeShift,
    LoweredMargin,
    LoweredMargins,
    NearestState,
    Stage,
    recorded_explanation,
)
from harness.recording.goal_failures import CollisionFailure, IkFailure, TouchRecord
from harness.recording.motion_failures import SearchFailure
from harness.recording.plan_statistics import PlanStatistics
from harness.recording.step_results import SavedDetails

TOUCH = TouchRecord(("wrist_3_link", "Table"), -0.004)
STAGES = (
    Stage("reach", "passed", "reached"),
    Stage("path", "failed", "blocked", "PLANNING_FAILED", ("after 30 %",)),
)
NEAREST = NearestState(
    "goal in collision",
    {"elbow_joint": 0.5},
    target=(0.1, 0.2, 0.3),
    touches=(TOUCH,),
    nearest_free=FreeShift((0.0, 0.0, 0.05), {"elbow_joint": 0.4}),
)


def saved(detail):
    """The details of a step whose run was saved."""
    return SavedDetails(saved=json.loads(json.dumps(detail.plain())))


def test_a_failure_finds_its_details_by_type_and_writes_them_as_one_mapping():
    failure = PlanningFailed("PLANNING_FAILED", "no way", CollisionFailure((TOUCH,)))
    failure.details += Details.of(SearchFailure(400, gap=1.5), None)
    assert failure.details.find(SearchFailure).gap == 1.5
    assert failure.details.find(IkFailure) is None
    assert failure.facts == {
        "touches": [{"pair": ["wrist_3_link", "Table"], "distance": -0.004}],
        "state_checks": 400,
        "gap": 1.5,
    }


def test_later_details_replace_the_values_of_earlier_ones_and_leave_the_rest():
    first, second = Explanation(STAGES, NEAREST, "move it"), Explanation(advice="turn it")
    merged = Details.of(first, second).plain()
    assert merged["advice"] == "turn it"
    assert merged["stages"] == first.plain()["stages"]
    assert Details.of(first).replaced(second).find(Explanation) is second


@pytest.mark.parametrize(
    "explanation", [Explanation(STAGES, NEAREST, "move it", "images/1.jpg"), Explanation()]
)
def test_an_explanation_is_read_back_from_its_json(explanation):
    assert recorded_explanation(saved(explanation)) == explanation


def test_an_explanation_that_does_not_fit_is_left_out():
    plain = Explanation(STAGES, NEAREST, "move it").plain()
    plain["nearest"]["joint_positions"] = [1.0, 2.0]
    assert recorded_explanation(SavedDetails(saved=plain)) == Explanation()


def test_lowered_margins_are_read_back_and_empty_where_no_motion_was_planned():
    margin = LoweredMargin(("cube", "Table"), 0.0, -0.0005)
    assert saved(LoweredMargins((margin,))).find(LoweredMargins).lowered_margins == (margin,)
    assert SavedDetails().find(LoweredMargins) is None


def test_a_detail_is_added_to_those_of_a_saved_run():
    drawn = saved(Explanation(STAGES, NEAREST)) + Details.of(Explanation(picture="images/1.jpg"))
    assert drawn.find(Explanation) == Explanation(STAGES, NEAREST, None, "images/1.jpg")
    assert drawn.find(PlanStatistics) is None
