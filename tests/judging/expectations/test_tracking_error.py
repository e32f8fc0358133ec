"""tracking_error: joints stay near their commands."""

from dataclasses import replace

import numpy as np
import pytest

from harness.plugins.arms.expectations.tracking_error import TrackingError
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import ROBOT, changed, make_run, verdict


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_tracking_is_of_the_arm_s_joints_where_they_have_commands():
    commands = positions(0.0, 0.03)
    commands[:10] = np.nan
    run = make_run(joint_commands=commands, joint_positions=positions(0.049))
    assert verdict(run, TrackingError()).margin == pytest.approx(0.001)
    assert verdict(run, TrackingError(max=0.048)).status == "failed"
    uncommanded = changed(run, joint_commands=np.full((200, 2), np.nan))
    assert verdict(uncommanded, TrackingError()).status == "not observable"


def test_a_joint_that_slides_may_be_5_mm_off_or_what_the_file_says():
    _, finger = ROBOT.movable_joints
    rail = replace(finger, name="rail")
    robot = replace(ROBOT, joints=(rail, finger), arm_group="")
    run = make_run(robot=robot, joint_positions=positions(0.004), joint_commands=positions(0.0))
    assert verdict(run, TrackingError()).margin == pytest.approx(0.001)
    assert verdict(run, TrackingError()).unit == "m"
    assert verdict(run, TrackingError(max=0.05)).margin == pytest.approx(0.046)
    assert verdict(run, TrackingError(max=0.003)).status == "failed"


EVIDENCE = Evidence(
    three_runs=(
        Three(TrackingError(), make_run(), shared.with_joint(joint_positions=0.051), -0.001, "rad"),
    ),
    mutation_cases=((TrackingError(), shared.late(**shared.MOVING), "late"),),
    picture=(("pick", "1 deg"), ("late", "1 deg")),
    free_shifts=(
        Free(
            "fingers lag their command to press",
            "tracking_error",
            "joint_positions, joint_commands",
            "+-finger",
        ),
    ),
)
