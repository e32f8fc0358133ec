"""tracking_error: joints stay near their commands."""

import numpy as np
import pytest

from harness.expectations.tracking_error import TrackingError
from tests.assertions import evidence_runs as shared
from tests.assertions.evidence import Evidence, Free, Three
from tests.assertions.synthetic_run import changed, make_run, verdict


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
