"""Imported arms grasp and put down objects with grippers of their own."""

import numpy as np
import pytest

from harness.core.spatial import rotation_from_quat_wxyz
from harness.planning.collision.scene import CoalScene
from harness.plugins.authoring.robot_findings import states
from tests.planning.seven_joints import SRDF as SEVEN_SRDF
from tests.planning.seven_joints import seven_joint_urdf
from tests.robot.arm_files import load_arm, write_arm
from tests.robot.hands import (
    BLOCK,
    BLOCK_AT,
    FIVE_WITH_TURNING_JAW,
    GROUP,
    HAND,
    PALM,
    PICK,
    SIX,
    SIX_SRDF,
    SIX_WITH_JAW,
    write,
)
from tests.session.front_door import check, run


def test_an_imported_arm_with_its_own_gripper_holds_what_it_grasps(tmp_path):
    write(tmp_path)
    robot = "{urdf: arm.urdf, srdf: arm.srdf, base: {xyz: [0, 0, 1], rpy: [180 deg, 0, 0]}}"
    rest = """
        objects:
          - name: block
            pose: {xyz: [0, 0, 0.13]}
            box: {size: [0.03, 0.03, 0.06]}
            mass: 0.05
          - {name: stand, static: true, pose: {xyz: [0, 0, 0.05]}, box: {size: [0.1, 0.1, 0.1]}}
        expect:
          - grasped: {object: block, during: lift}
          - always: within_limits
    """
    steps = """
        - gripper: open
        - move_to: {joints: {turn: 0, bend: 0, reach: 0.11}}
        - grasp: {object: block}
        - {move_to: {joints: {reach: 0.02}}, id: lift}
    """
    group = GROUP + (
        '<group_state name="open" group="hand"><joint name="left_joint" value="0.03"/>'
        "</group_state>"
    )
    write(tmp_path, group=group)
    result, saved = run(tmp_path, steps, robot=robot, rest=rest)
    assert result.outcome == "passed", [step.message for step in result.steps]
    assert np.ptp(saved.signals.joint_positions[-1][-2:]) < 1e-3, "the fingers stay coupled"


def test_a_hand_that_starts_closed_takes_a_box_from_above(tmp_path):
    write_arm(tmp_path, SIX, SIX_SRDF)
    rest = """
        objects:
          - {name: block, pose: {xyz: [0.3, 0, 0.03]}, box: {size: [0.03, 0.05, 0.06]}}
    """
    found = check(
        tmp_path, "- pick: {object: block}", robot="{urdf: arm.urdf, srdf: arm.srdf}", rest=rest
    )
    assert (found.problems, found.predicted) == ((), ())


@pytest.mark.nightly
def test_a_single_jaw_closes_an_object_on_the_palm(tmp_path):
    assert SIX_WITH_JAW != SIX
    write_arm(tmp_path, SIX_WITH_JAW)
    result, saved = run(tmp_path, PICK, robot="{urdf: arm.urdf}", rest=BLOCK)
    assert result.outcome == "passed", [step.message for step in result.steps]
    height = saved.signals.object_poses["block"][:, 2]
    assert height[-1] - height[0] > 0.045


@pytest.mark.nightly
def test_a_palm_near_the_pads_does_not_touch_what_is_grasped(tmp_path):
    """The TCP stays above the depth of other grasps where the fingers are short."""
    palm = PALM.replace(
        "</link>",
        """<collision><origin xyz="0 0 0.02"/><geometry><box size="0.1 0.1 0.04"/></geometry>
    </collision></link>""",
        1,
    )
    short = SIX.replace(PALM, palm)
    assert short != SIX
    write_arm(tmp_path, short, SIX_SRDF)
    robot = "{urdf: arm.urdf, srdf: arm.srdf}"
    result, _ = run(tmp_path, PICK, robot=robot, rest=BLOCK)
    assert result.outcome == "passed", [step.message for step in result.steps]


@pytest.mark.nightly
def test_an_arm_of_five_joints_puts_down_what_its_jaw_took(tmp_path):
    """Its TCP's z axis points out of the hand, so that a pitch of the x axis says nothing."""
    write_arm(tmp_path, FIVE_WITH_TURNING_JAW)
    rest = """
        objects:
          - {name: block, pose: {xyz: [0.25, 0, 0.217]}, box: {size: [0.015, 0.015, 0.034]},
             mass: 0.05, friction: 0.3}
          - {name: stand, static: true, pose: {xyz: [0.25, 0, 0.1]}, box: {size: [0.2, 0.2, 0.2]}}
          - {name: shelf, static: true, pose: {xyz: [0, 0.3, 0.1]}, box: {size: [0.2, 0.2, 0.2]}}
        expect:
          - placed: {object: block, on: shelf}
    """
    steps = PICK + "\n- place: {object: block, pose: {xyz: [0, 0.3, 0.217]}}"
    result, saved = run(tmp_path, steps, robot="{urdf: arm.urdf}", rest=rest)
    assert result.outcome == "passed", [step.message for step in result.steps]
    assert saved.signals.object_poses["block"][-1, :2] == pytest.approx([0, 0.3], abs=0.01)


def test_the_posture_before_a_grasp_is_one_from_which_the_arm_can_approach(tmp_path):
    """The nearest posture that reaches the pose ends at a joint limit half way down."""
    srdf = SEVEN_SRDF.replace('"arm"', '"manipulator"').replace("</robot>", GROUP + "</robot>")
    write_arm(tmp_path, seven_joint_urdf().replace("</robot>", HAND + "</robot>"), srdf)
    rest = """
        seed: 3
        objects:
          - name: cube
            pose: {xyz: [0.3, -0.25, 0.03]}
            box: {size: [0.03, 0.03, 0.06]}
            mass: 0.05
    """
    pick = "- pick: {object: cube, lift: {distance: 5 cm}}"
    result, _ = run(tmp_path, pick, robot="{urdf: arm.urdf, srdf: arm.srdf}", rest=rest)
    assert result.outcome == "passed", [step.message for step in result.steps]


def test_a_line_of_five_joints_keeps_the_gripper_upright(tmp_path):
    write_arm(tmp_path, FIVE_WITH_TURNING_JAW)
    steps = """
        - move_to: {joints: {b_joint: 0.6, c_joint: 1.5, e_joint: 0.5}}
        - move_relative: {direction: {xyz: [0.3, 1, 0]}, distance: 0.15}
    """
    _, saved = run(tmp_path, steps, robot="{urdf: arm.urdf}")
    poses = saved.signals.tcp_pose[saved.signals.times > saved.steps[1].start_time]
    up = np.array([rotation_from_quat_wxyz(pose[3:])[2] for pose in poses])
    assert np.ptp(poses[:, 1]) > 0.1
    assert np.abs(up - up[0]).max() < 0.01


def test_a_state_of_the_gripper_is_good_wherever_the_arm_stands(tmp_path):
    """At zero, an open finger touches the arm, as on a folded Panda."""
    urdf = SIX
    for link, place in (("c", "0 0.07 0.5"), ("d", "0.3 0 0")):
        start = f'<link name="{link}">'
        urdf = urdf.replace(start, start + BLOCK_AT.format(place))
    write_arm(tmp_path, urdf)
    arm = load_arm(tmp_path, srdf=None)
    opened = arm.start_positions(arm.states_of("gripper")["open"].positions)
    assert CoalScene(arm).touches(opened)
    assert states(arm).is_good
