"""Robots of `robots`: one description, with the arm's name in front of every name."""

import numpy as np
import pytest

from harness.core.errors import RobotError, RobotOptionError
from harness.language.scenario import RobotSpec
from harness.plugins.assembly.several_arms import ALL_ARMS, joined_arms
from harness.robot.load import load_robot

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


FINGER = """<link name="{name}"><inertial><mass value="0.02"/>
<inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/></inertial>
<collision><origin xyz="0 0 0.03"/><geometry><box size="0.01 0.01 0.06"/></geometry>
</collision></link><joint name="{name}_slide" type="prismatic"><parent link="{parent}"/>
<child link="{name}"/><origin xyz="{x} 0 0.1"/><axis xyz="{axis} 0 0"/>
<limit lower="0" upper="0.04" velocity="0.5" effort="20"/>{mimic}</joint>"""
LINK = """<link name="{name}"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01"/>
</inertial><collision><origin xyz="0 0 0.05"/><geometry><box size="0.04 0.04 0.08"/></geometry>
</collision></link><joint name="{name}_joint" type="revolute"><parent link="{parent}"/>
<child link="{name}"/><origin xyz="{x} 0 0.1"/><axis xyz="{axis}"/>
<limit lower="-2" upper="2" velocity="2" effort="50"/></joint>"""


def side(name, x, joints):
    """An arm with two fingers, of which the second follows the first."""
    links = ["body", *(f"{name}_{number}" for number in range(joints))]
    text = ""
    for number in range(joints):
        words = {"name": links[number + 1], "parent": links[number], "x": 0 if number else x}
        text += LINK.format(**words, axis="0 0 1" if number % 2 == 0 else "0 1 0")
    mimic = f'<mimic joint="{name}_near_slide"/>'
    text += FINGER.format(name=f"{name}_near", parent=links[-1], x=-0.01, axis="-1", mimic="")
    return text + FINGER.format(name=f"{name}_far", parent=links[-1], x=0.01, axis="1", mimic=mimic)


def two_armed(folder, joints=6, **options):
    sides = side("l", -0.4, joints) + side("r", 0.4, joints)
    text = f"<robot name='two'><link name='body'/>{sides}</robot>"
    (folder / "two.urdf").write_text(text, encoding="utf-8")
    return load_robot(RobotSpec.model_validate({"urdf": "two.urdf", **options}), folder)


SRDF = """<robot name="two">
<group name="one_arm"><chain base_link="body" tip_link="l_5"/></group>
<group name="other_arm"><chain base_link="body" tip_link="r_5"/></group>
<group name="one_hand"><joint name="l_near_slide"/></group>
<group name="other_hand"><joint name="r_near_slide"/></group>
<end_effector name="a" parent_link="l_5" group="one_hand" parent_group="one_arm"/>
<end_effector name="b" parent_link="r_5" group="other_hand" parent_group="other_arm"/>
</robot>"""


@pytest.mark.parametrize("joints", [5, 6])
def test_a_file_with_two_arms_has_an_arm_for_each(tmp_path, joints):
    found = two_armed(tmp_path, joints)
    assert found.needs_arm
    assert [arm.name for arm in found.arms] == ["l", "r"]
    assert [arm.gripper.joint for arm in found.arms] == ["l_near_slide", "r_near_slide"]
    for arm in found.arms:
        assert found.groups[arm.name].tip_link == arm.tcp_link
    assert len(found.group_joints(ALL_ARMS)) == 2 * joints


def test_an_srdf_names_arms_by_its_end_effectors(tmp_path):
    (tmp_path / "two.srdf").write_text(SRDF, encoding="utf-8")
    found = two_armed(tmp_path, srdf="two.srdf")
    grippers = {arm.name: arm.gripper.group for arm in found.arms}
    assert grippers == {"one_arm": "one_hand", "other_arm": "other_hand"}
    stated = two_armed(tmp_path, srdf="two.srdf", group="other_arm")
    assert stated.default_arm == "other_arm"
    assert stated.arms[0].name == stated.arm_group == "other_arm"


WAISTED = """<group name="long_one"><chain base_link="root" tip_link="l_5"/></group>
<group name="long_other"><chain base_link="root" tip_link="r_5"/></group>"""


@pytest.mark.parametrize("is_waist_first", [True, False])
def test_an_end_effector_that_names_no_arm_hangs_on_the_shortest_one(tmp_path, is_waist_first):
    """As of PR2: its end effectors have a parent link alone, and a torso carries both arms."""
    groups = SRDF.replace(' parent_group="one_arm"', "").replace(' parent_group="other_arm"', "")
    head = groups.partition("\n")[0]
    place = head if is_waist_first else '<group name="one_hand">'
    groups = groups.replace(place, head + WAISTED if is_waist_first else WAISTED + place)
    (tmp_path / "two.srdf").write_text(groups, encoding="utf-8")
    waist = LINK.format(name="body", parent="root", x=0, axis="0 0 1").replace(
        "body_joint", "waist"
    )
    sides = side("l", -0.4, 6) + side("r", 0.4, 6)
    text = f"<robot name='two'><link name='root'/>{waist}{sides}</robot>"
    (tmp_path / "two.urdf").write_text(text, encoding="utf-8")
    spec = RobotSpec.model_validate({"urdf": "two.urdf", "srdf": "two.srdf"})
    grippers = {arm.name: arm.gripper.group for arm in load_robot(spec, tmp_path).arms}
    assert grippers == {"one_arm": "one_hand", "other_arm": "other_hand"}


@pytest.mark.parametrize("joints", [2, 4])
def test_chains_as_short_as_fingers_are_no_arms(tmp_path, joints):
    found = two_armed(tmp_path, joints)
    assert not found.arms


def test_a_stated_tcp_says_which_arm_is_the_default(tmp_path):
    found = two_armed(tmp_path, tcp_link="r_5")
    assert found.arm_group == "arm"
    assert found.default_arm in ("", "arm")
    assert found.groups["arm"].joint_names == tuple(f"r_{number}_joint" for number in range(6))
