"""released: no part of the gripper touches the object, and it is not attached."""

import pytest

from harness.judging.expectations.released import Released
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import attachment, lift_run, verdict


def test_a_box_let_go_is_released_and_one_still_touched_or_attached_is_not():
    assert verdict(lift_run(grip=(50, 150)), Released(object="box")).status == "passed"
    answer = verdict(lift_run(grip=(50, 200), value=0.01), Released(object="box"))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.019)
    attached = lift_run(grip=(50, 150), attachments=[attachment("box", 60, 200)])
    found = verdict(attached, Released(object="box"))
    assert found.reason.startswith("the robot does not touch box; attached")
    assert verdict(attached, Released(object="box")).status == "failed"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Released(object="box"),
            shared.touched(0.0),
            lift_run(value=0.00052),
            -4e-5,
            "N",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=((Released(object="box"), shared.standing(), "late"),),
    picture=(("pick", "red_box"), ("pick", "{object: red_box, during: lift}")),
    free_shifts=(
        Free(
            "no force of the fingers is released",
            "released",
            "contact_forces left_finger, contact_forces right_finger",
            "-",
        ),
    ),
)
