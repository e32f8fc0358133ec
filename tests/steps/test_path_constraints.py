"""Path constraints of `move_to` on what the hand holds."""

import numpy as np
import pytest

from harness.core.pose_arrays import rotate
from tests.session.front_door import problems, run

ARM = "{model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 0.4]}}"
BOTTLE = """
objects:
  - {name: stand, static: true, box: {size: [0.1, 0.1, 0.4]}, pose: {xyz: [0.28, 0.12, 0.2]}}
  - name: bottle
    cylinder: {radius: 0.02, length: 0.12}
    mass: 0.1
    pose: {xyz: [0.28, 0.12, 0.46]}
  - {name: post, static: true, box: {size: [0.04, 0.04, 0.9]}, pose: {xyz: [0.42, 0, 0.45]}}
planning: {max_velocity_scaling_factor: 0.3, max_acceleration_scaling_factor: 0.3}
"""


@pytest.mark.nightly
def test_a_bottle_in_the_hand_stays_upright_on_the_way_to_a_position(tmp_path):
    """A position leaves the orientation of the hand open: it ends with the bottle upright too."""
    steps = """
    - pick: bottle
    - move_to:
        position: {xyz: [0.25, -0.25, 0.7]}
        path_constraints:
          orientation: {link: bottle, pose: {frame: world}, tolerance: [0.12, 0.12, 3.15]}
      expect:
        - always: {upright: {object: bottle, tolerance: 0.15}}
    """
    result, record = run(tmp_path, steps, robot=ARM, rest=BOTTLE)
    assert result.outcome == "passed", result.message
    moved = record.signals.tcp_pose[-1, :3]
    assert moved == pytest.approx([0.25, -0.25, 0.7], abs=5e-3)


SHAFT = """
- move_to: {joints: {shoulder_pan_joint: 0, shoulder_lift_joint: -1.2, elbow_joint: 1.6}}
- attach_object:
    object:
      name: shaft
      in: planning
      box: {size: [0.02, 0.02, 0.2]}
      pose: {frame: end_effector_link, xyz: [0, 0, 0.15]}
- move_to:
    joints: {shoulder_pan_joint: 1.2, shoulder_lift_joint: -1.4, elbow_joint: 1.4}
    path_constraints:
      position: {link: shaft, center: {frame: world, xyz: [0, 0, 0.6]}, size: [1.4, 1.4, %s]}
"""


@pytest.mark.nightly
def test_the_origin_of_an_attached_object_stays_in_a_box(tmp_path):
    result, record = run(tmp_path, SHAFT % "1.0", robot=ARM)
    assert result.outcome == "passed", result.message
    tcp = record.signals.tcp_pose
    heights = tcp[:, 2] + rotate(tcp[:, 3:], np.array([0.0, 0.0, 0.15]))[:, 2]
    started = record.steps[2].start_time
    assert np.all(np.abs(heights[record.signals.times >= started] - 0.6) < 0.505)
    result, _ = run(tmp_path, SHAFT % "0.01", robot=ARM)
    assert result.steps[2].error_code == "START_STATE_VIOLATES_PATH_CONSTRAINTS"
    assert "shaft is" in result.steps[2].message


@pytest.mark.parametrize(
    ("steps", "line", "message"),
    [
        (
            "[{move_to: {named_target: up, path_constraints: {orientation: "
            "{link: bottle, pose: {frame: world}, tolerance: [1, 1, 1]}}}}]",
            5,
            "no link 'bottle'",
        ),
        (
            "[{attach_object: bottle}, {detach_object: bottle}, {move_to: {named_target: up, "
            "path_constraints: {position: {link: bottle, center: [0, 0, 0], size: [1, 1, 1]}}}}]",
            5,
            "no link 'bottle'",
        ),
        (
            "[{attach_object: bottle}, {move_to: {position: [0.2, 0.2, 0.8], link: bottle}}]",
            5,
            "`position` is a goal for a link, and 'bottle' is an attached object",
        ),
    ],
)
def test_an_object_that_is_not_attached_there_is_no_link(tmp_path, steps, line, message):
    ((found, said),) = problems(tmp_path, steps, robot=ARM, rest=BOTTLE)
    assert found == line
    assert message in said
