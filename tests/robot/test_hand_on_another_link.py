"""Hands on another link than the arm's tip."""

import pytest

from tests.robot.arm_files import SHAPE, SRDF, URDF, load_arm, write_arm
from tests.robot.hands import HAND, LIGHT, UNCOUPLED

VIRTUAL = f"""<link name="v1">{LIGHT}</link><link name="v2">{LIGHT}{{shape}}</link><link name="v3"/>
<joint name="roll" type="revolute"><parent link="wrist"/><child link="v1"/><origin xyz="0 0 0.2"/>
  <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="2" effort="30"/></joint>
<joint name="yaw" type="revolute"><parent link="v1"/><child link="v2"/>
  <axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="2" effort="30"/></joint>
<joint name="v3_joint" type="fixed"><parent link="v2"/><child link="v3"/></joint>
"""
GROUP = '<group name="hand"><joint name="left_joint"/>{}</group>'
TIP = SRDF.replace('tip_link="tool"', 'tip_link="v3"')


def load(folder, group, *, shape="", hand=HAND, **options):
    """An arm with two joints beyond the link that carries its hand."""
    end = "</robot>"
    urdf = URDF.replace(end, VIRTUAL.format(shape=shape) + hand + end)
    write_arm(folder, urdf, TIP.replace(end, group + end))
    return load_arm(folder, **options)


@pytest.mark.parametrize("shape", ["", SHAPE])
@pytest.mark.parametrize("hand", [HAND, UNCOUPLED])
def test_a_group_next_to_the_last_joints_is_the_hand(tmp_path, shape, hand):
    group = GROUP.format('<joint name="right_joint"/>' if hand == UNCOUPLED else "")
    arm = load(tmp_path, group, shape=shape, hand=hand)
    assert arm.groups["manipulator"].joint_names == ("turn", "bend", "reach", "roll", "yaw")
    assert (arm.gripper.group, arm.gripper.joint, arm.tcp_link) == ("hand", "left_joint", "v3")
    assert any("'v3', which moves relative to the gripper's palm 'palm'" in n for n in arm.notes)
    named = load(tmp_path, group, shape=shape, hand=hand, gripper="hand")
    assert named.gripper.joint == arm.gripper.joint


def test_a_group_of_another_parent_in_the_end_effector_is_the_hand(tmp_path):
    tool = '<end_effector name="ee" parent_link="v3" group="manipulator"/>'
    assert load(tmp_path, GROUP.format("") + tool).gripper.joint == "left_joint"


@pytest.mark.parametrize("options", [{}, {"srdf": None}])
def test_a_hand_without_a_group_is_found_before_joints_that_move_no_shape(tmp_path, options):
    assert load(tmp_path, "", **options).gripper.joint == "left_joint"


def test_the_hand_of_another_arm_is_none_of_this_one(tmp_path):
    other = URDF.replace("continuous", "revolute").replace(
        '<limit velocity="2" effort="30"/>',
        '<limit lower="-1" upper="1" velocity="2" effort="30"/>',
    )
    for name in ("upper", "lower", "wrist", "tool", "turn", "bend", "reach", "tip"):
        other = other.replace(f'"{name}"', f'"other_{name}"')
    links = other[other.index('<link name="other_upper"') : other.index("</robot>")]
    links = links.replace('"base_link"', '"upper"')  # the first joint carries both arms
    hand = HAND.replace('<parent link="tool"/>', '<parent link="other_tool"/>')
    write_arm(
        tmp_path,
        URDF.replace("</robot>", links + hand + "</robot>"),
        SRDF.replace("</robot>", GROUP.format("") + "</robot>"),
    )
    arm = load_arm(tmp_path)
    assert arm.groups["manipulator"].joint_names == ("turn", "bend", "reach")
    assert arm.gripper is None
