"""Robots of `robots`: one description, with the arm's name in front of every name."""

import numpy as np
import pytest

from harness.core.errors import RobotError, RobotOptionError
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from harness.robot.several_arms import ALL_ARMS, joined_arms

UR = {"model": "ur3e", "gripper": "rh_p12_rn_a"}
SMALL = {"model": "open_manipulator_x"}


def robot(words, x=0.0):
    return load_robot(RobotSpec.model_validate({**words, "base": {"xyz": [x, 0, 0]}}))


def pair(first=UR, second=SMALL):
    return joined_arms({"big": robot(first), "small": robot(second, 1.0)})


def test_every_link_stands_where_it_stands_alone():
    both = pair()
    poses = both.link_poses(both.start_positions())
    for name, words, x in (("big", UR, 0.0), ("small", SMALL, 1.0)):
        alone = robot(words, x)
        for link, pose in alone.link_poses(alone.start_positions()).items():
            if link != "world":
                found = poses[f"{name}_{link}"].as_vector()
                np.testing.assert_allclose(found, pose.as_vector(), atol=1e-12)


def test_groups_states_and_grippers_have_the_names_of_their_arms():
    both = pair()
    assert {"big", "big_gripper", "small", "small_gripper", ALL_ARMS} <= set(both.groups)
    assert both.group_joints(ALL_ARMS) == both.group_joints("big") + both.group_joints("small")
    assert both.groups["small"].tip_link == "small_end_effector_link"
    assert [gripper.joint for gripper in both.grippers] == [
        "big_rh_r1_joint",
        "small_gripper_left_joint",
    ]
    assert set(both.states_of(ALL_ARMS)) == {"home"}  # what only one arm has is no state of both
    assert both.cameras["small_gripper_camera"].frame == "small_gripper_camera_link"
    assert both.arm_of_group("small_gripper") == "small"
    assert both.arm_of_group(ALL_ARMS) == ""


def test_no_contact_between_two_arms_is_allowed():
    both = pair()
    owners = [{name.split("_")[0] for name in pair} for pair in both.allowed_collisions]
    assert all(len(names - {"world"}) == 1 for names in owners)


def test_an_arm_is_selected_with_its_gripper_and_tcp():
    both = pair()
    assert both.needs_arm
    small = both.of_arm["small"]
    assert not small.needs_arm
    assert (small.arm_group, small.tcp_link) == ("small", "small_end_effector_link")
    assert small.gripper.group == "small_gripper"
    assert small.recorded_tcp == both.tcp_link == "big_end_effector_link"


@pytest.mark.parametrize(
    ("names", "clash"), [(("arms", "b"), "called arms"), (("a", "a_gripper"), "called a_gripper")]
)
def test_names_that_would_clash_are_refused(names, clash):
    robots = dict(zip(names, (robot(UR), robot(UR, 1.0)), strict=True))
    with pytest.raises(RobotError, match=clash):
        joined_arms(robots)


def test_arms_have_the_same_joint_controller():
    other = robot({"model": "ur3e", "joint_controller": "pd_servo"}, 1.0)
    with pytest.raises(RobotOptionError, match="joint_controller"):
        joined_arms({"a": robot({"model": "ur3e"}), "b": other})
