"""joints: joints stand at positions."""

import numpy as np
import pytest

from harness.judging.expectations.gripper import GripperState
from harness.judging.expectations.joints import Joints
from harness.plugins.arms.expectations.named_target import NamedTarget
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Three
from tests.judging.synthetic_run import make_run, verdict


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_joints_and_named_targets_report_the_worst_joint():
    run = make_run(joint_positions=positions(0.009))
    assert verdict(run, NamedTarget(state="home")).margin == pytest.approx(0.001)
    assert verdict(run, NamedTarget(state="home", tolerance=0.008)).status == "failed"
    answer = verdict(run, Joints(positions={"shoulder": 0.02, "finger": 0.0}))
    assert answer.status == "failed"
    assert answer.reason.startswith("shoulder is off")
    assert verdict(run, NamedTarget(state="up")).status == "not observable"
    assert verdict(run, NamedTarget(state="home", during="later")).status == "not reached"
    assert verdict(run, Joints(positions={"elbow": 0.0})).status == "not observable"


def test_an_angle_s_default_tolerance_is_not_taken_for_a_sliding_joint():
    run = make_run(joint_positions=positions(0.0, 0.005))
    assert verdict(run, GripperState(named_target="closed")).status == "failed"
    assert verdict(run, GripperState(named_target="closed", tolerance=0.006)).status == "passed"
    assert verdict(run, NamedTarget(state="closed", group="gripper")).status == "failed"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Joints(positions={"shoulder": 0.0}),
            make_run(),
            shared.with_joint(joint_positions=0.0101),
            -1e-4,
            "rad",
        ),
    ),
    mutation_cases=(
        (Joints(positions={"shoulder": 0.0, "finger": 0.02}), shared.late(**shared.MOVING), "late"),
    ),
    picture=(
        ("late", "{positions: {joint1: 40 deg}, tolerance: 1 deg}"),
        ("stalled", "{positions: {joint1: 40 deg}, tolerance: 1 deg}"),
    ),
)
