"""`move_to` with `poses`: the TCP of each of several arms goes to a pose of its own."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.steps.test_several_arms import PAIR, found

POSES = f"""
scenario: both arms at once
{PAIR}
steps:
  - id: together
    move_to:
      poses:
        left: {{xyz: [0.3, 0.25, 0.3], rpy: [180 deg, 0, 0]}}
        right: {{xyz: [0.3, -0.25, 0.25], rpy: [180 deg, 0, 0]}}
    expect:
      - tcp_pose: {{by: left, pose: {{xyz: [0.3, 0.25, 0.3], rpy: [180 deg, 0, 0]}}}}
      - tcp_pose: {{by: right, pose: {{xyz: [0.3, -0.25, 0.25], rpy: [180 deg, 0, 0]}}}}
  - id: same_place
    move_to:
      poses:
        left: {{xyz: [0.25, 0.0, 0.25], rpy: [180 deg, 0, 0]}}
        right: {{xyz: [0.25, 0.02, 0.25], rpy: [180 deg, 0, 0]}}
    expect_error: GOAL_IN_COLLISION
  - id: far
    move_to: {{poses: {{left: {{xyz: [0.3, 0.25, 0.3]}}, right: {{xyz: [3, 0, 0.3]}}}}}}
    expect_error: NO_IK_SOLUTION
expect:
  - never: collision
"""


@pytest.fixture
def run(recorded_run):
    return read_run(recorded_run(POSES) / "run").run


def test_both_arms_reach_their_poses_in_one_motion(run):
    [step, *_] = run.steps
    assert len(step.trajectory.joint_names) == 12
    moved = np.abs(step.trajectory.positions[-1] - step.trajectory.positions[0]) > 1e-3
    assert moved[:6].any()
    assert moved[6:].any()
    assert step.trajectory.velocities[-1] == pytest.approx(0.0, abs=1e-6)


def test_the_arm_that_cannot_reach_is_explained(run):
    far = next(step for step in run.steps if step.id == "far")
    assert "right_" in far.message
    assert "(3000, 0, 300) mm" in far.message


@pytest.mark.parametrize(
    ("poses", "message"),
    [
        ("{middle: {xyz: [0.3, 0, 0.3]}}", "there is no arm 'middle'"),
        ("{left: {xyz: [0.3, 0, 0.3], frame: table}}", "there is no frame 'table'"),
    ],
)
def test_names_that_do_not_exist(poses, message, tmp_path):
    assert message in [each[1] for each in found(tmp_path, f"  - move_to: {{poses: {poses}}}\n")]


def test_a_group_without_the_arm(tmp_path):
    step = "  - move_to: {poses: {left: {xyz: [0.3, 0.3, 0.3]}}}\n    group: right\n"
    assert [each[1] for each in found(tmp_path, step)] == [
        "the joints of 'left' are not in the group 'right'"
    ]


def test_one_arm_has_no_poses_by_name(tmp_path):
    step = "  - move_to: {poses: {left: {xyz: [0.3, 0.3, 0.3]}}}\n"
    messages = [each[1] for each in found(tmp_path, step, robot="robot: ur3e\n")]
    assert messages
