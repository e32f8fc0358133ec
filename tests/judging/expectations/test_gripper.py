"""gripper: the gripper stands at a named state, a position or a width, or is stalled."""

import numpy as np
import pytest

from harness.judging.expectations.gripper import GripperState
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import gripped, make_run, step, verdict


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_the_gripper_by_state_position_width_and_report():
    run = make_run(
        joint_positions=positions(0.0, 0.029),
        steps=(
            step("open", 0, 50, "gripper", result=gripped(stalled=False)),
            step("squeeze", 50, 100, "gripper", result=gripped(stalled=True)),
            step("never", 200, 200, "gripper", "not reached"),
        ),
    )
    assert verdict(run, GripperState(named_target="open")).margin == pytest.approx(0.001)
    assert verdict(run, GripperState(position=0.0265)).status == "failed"
    assert verdict(run, GripperState(width=0.059)).margin == pytest.approx(0.001)
    assert verdict(run, GripperState(width=0.0601)).status == "failed"
    assert verdict(run, GripperState(stalled=True)).status == "passed"
    unstalled = verdict(run, GripperState(stalled=True), "open")
    assert unstalled.status == "failed"
    assert unstalled.reason.startswith("the gripper did not stall")
    assert verdict(run, GripperState(stalled=True)).reason.startswith("the gripper stalled")
    assert verdict(run, GripperState(stalled=False), "open").status == "passed"
    assert verdict(run, GripperState(stalled=False), "never").status == "not reached"
    assert verdict(make_run(), GripperState(stalled=False)).status == "not reached"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            GripperState(position=0.0199, tolerance=0.001),
            make_run(),
            make_run(joint_positions=np.tile([0.0, 0.02095], (shared.N, 1))),
            -5e-5,
            "m",
        ),
    ),
    mutation_cases=(
        (
            GripperState(position=0.02),
            shared.late(joint_positions=shared.columns(0, (0, 0.02))),
            "late",
        ),
        (
            GripperState(width=0.04),
            shared.late(joint_positions=shared.columns(0, (0, 0.02))),
            "late",
        ),
        (GripperState(stalled=True), make_run(steps=shared.REPORTS), "late"),
    ),
    picture=(("pick", "open"), ("pick", "close")),
    free_shifts=(
        Free("the other group's joints", "gripper, gripper 2", "joint_positions", "+-shoulder"),
    ),
)
