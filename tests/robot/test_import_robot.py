"""Robots from URDF and SRDF files of their own."""

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

from harness.core.errors import RobotError, SpecError
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.robot.load import load_robot
from harness.robot.urdf.urdf import parse_urdf
from tests.robot.arm_files import INERTIAL, SHAPE, SRDF, URDF, load_arm, write_arm
from tests.session.front_door import run


def joint(link, parent, axis="0 0 1", mimic=""):
    """A link and the joint that turns it."""
    return (
        f'<link name="{link}">{INERTIAL}</link><joint name="{link}_joint" type="revolute">'
        f'<parent link="{parent}"/><child link="{link}"/><axis xyz="{axis}"/>'
        f'<limit lower="-1" upper="1" velocity="1" effort="30"/>{mimic}</joint>'
    )


def fixed(parent, link):
    """A joint that holds a link."""
    return (
        f'<joint name="{link}_fixed" type="fixed"><parent link="{parent}"/>'
        f'<child link="{link}"/></joint>'
    )


def fingers(parent, *, mimic=False):
    """Two fingers; the second follows the first, or moves alone."""
    follows = '<mimic joint="one_joint" multiplier="-1"/>' if mimic else ""
    return joint("one", parent, "1 0 0") + joint("two", parent, "1 0 0", follows)


def test_urdf_and_srdf_make_a_robot(tmp_path):
    write_arm(tmp_path)
    arm = load_arm(tmp_path)
    assert (arm.name, arm.arm_group, arm.tcp_link) == ("three", "manipulator", "tool")
    assert arm.groups["manipulator"].joint_names == ("turn", "bend", "reach")
    assert arm.start_state == {"turn": 0.1, "bend": 0.7, "reach": 0.05}
    assert [joint.kind for joint in arm.movable_joints] == ["continuous", "revolute", "prismatic"]
    assert arm.allowed_collisions["upper", "wrist"] == "Never"
    assert arm.allowed_collisions["lower", "upper"] == "Adjacent"


def test_without_an_srdf_the_longest_chain_is_the_arm(tmp_path):
    write_arm(tmp_path)
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names == ("turn", "bend", "reach")
    assert (arm.tcp_link, arm.start_state) == ("tool", {"turn": 0.0, "bend": 0.0, "reach": 0.0})
    assert "no SRDF: only neighbouring links may touch" in arm.notes


def test_fingers_that_follow_each_other_are_no_part_of_the_arm(tmp_path):
    hand = '<link name="hand"/>' + fixed("tool", "hand")
    write_arm(tmp_path, URDF.replace("</robot>", f"{hand}{fingers('hand', mimic=True)}</robot>"))
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names == ("turn", "bend", "reach")
    assert arm.tcp_link == "hand"
    write_arm(tmp_path, URDF.replace("</robot>", f"{hand}{fingers('hand')}</robot>"))
    alone = load_arm(tmp_path, srdf=None)
    assert (alone.groups["arm"].joint_names, alone.tcp_link) == (("turn", "bend", "reach"), "hand")


def test_a_joint_that_a_linkage_follows_is_the_arms(tmp_path):
    rod = joint("rod", "upper", "0 1 0", '<mimic joint="bend" multiplier="-1"/>')
    write_arm(tmp_path, URDF.replace("</robot>", f"{rod}</robot>"))
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names == ("turn", "bend", "reach")


def test_of_several_arms_the_first_moves_and_the_others_are_reported(tmp_path):
    def arm(side):
        return joint(f"{side}_a", "base_link") + joint(f"{side}_b", f"{side}_a")

    base = f'<robot name="two"><link name="base_link">{INERTIAL}</link>'
    write_arm(tmp_path, f"{base}{arm('left')}{arm('right')}</robot>")
    found = load_arm(tmp_path, srdf=None)
    assert found.groups["arm"].joint_names == ("left_a_joint", "left_b_joint")
    assert any("several chains" in note and "right_b" in note for note in found.notes)
    other = load_arm(tmp_path, srdf=None, tcp_link="right_b")
    assert other.groups["arm"].joint_names == ("right_a_joint", "right_b_joint")
    assert not any("several chains" in note for note in other.notes)


def serial(name, parent, count, limit="30"):
    """A chain of joints, each on the one before."""
    links = [parent, *(f"{name}{number}" for number in range(1, count + 1))]
    text = "".join(joint(after, before) for before, after in pairwise(links))
    return text.replace('effort="30"', f'effort="{limit}"')


def arm_joints(folder, joints):
    """Names of the links that the joints of the arm move, in a robot of joints without an SRDF."""
    write_arm(
        folder, f'<robot name="tree"><link name="base_link">{INERTIAL}</link>{joints}</robot>'
    )
    arm = load_arm(folder, srdf=None)
    return [name.removesuffix("_joint") for name in arm.groups["arm"].joint_names]


SEVEN = [f"a{number}" for number in range(1, 8)]


@pytest.mark.parametrize(
    "sibling",
    [
        joint("flap", "a6").replace('lower="-1" upper="1"', 'lower="0" upper="0.9"'),
        joint("flap", "a6").replace('effort="30"', 'effort="2"'),
        joint("flap", "a6")
        .replace("revolute", "prismatic")
        .replace('lower="-1" upper="1"', 'lower="0" upper="0.05"'),
    ],
)
@pytest.mark.parametrize("is_first", [False, True])
def test_a_joint_next_to_the_wrist_that_is_no_finger_does_not_end_the_arm(
    tmp_path, sibling, is_first
):
    arm = serial("a", "base_link", 7)
    assert arm_joints(tmp_path, sibling + arm if is_first else arm + sibling) == SEVEN


def test_a_joint_that_moves_nothing_next_to_every_joint_does_not_end_the_arm(tmp_path):
    links = ["base_link", *SEVEN]
    springs = "".join(joint(f"{link}_spring", link) for link in links)
    arm = serial("a", "base_link", 7).replace("</inertial></link>", f"</inertial>{SHAPE}</link>")
    assert arm_joints(tmp_path, springs + arm)[:7] == SEVEN


@pytest.mark.parametrize("torso", [1, 3])
@pytest.mark.parametrize("hand", [0, 1, 2])
def test_a_torso_with_two_arms_has_the_first_of_them(tmp_path, torso, hand):
    trunk = serial("t", "base_link", torso)
    sides = "".join(
        serial(side, f"t{torso}", 7)
        + "".join(serial(f"{side}_{finger}", f"{side}7", hand, "2") for finger in "ab")
        for side in ("left", "right")
    )
    joints = arm_joints(tmp_path, trunk + sides)
    assert joints == [f"t{n}" for n in range(1, torso + 1)] + [f"left{n}" for n in range(1, 8)]


@pytest.mark.parametrize(("fingers", "count"), [("ab", 1), ("abc", 2), ("abcd", 4)])
def test_fingers_that_move_alone_end_the_arm(tmp_path, fingers, count):
    hand = "".join(serial(f"finger_{name}", "a7", count, "2") for name in fingers)
    assert arm_joints(tmp_path, serial("a", "base_link", 7) + hand) == SEVEN


def test_a_root_called_world_stands_in_the_harness_world(tmp_path):
    write_arm(
        tmp_path, URDF.replace('"base_link"', '"world"'), SRDF.replace('"base_link"', '"world"')
    )
    arm = load_arm(tmp_path, base={"xyz": [0, 0, 1]})
    assert arm.link_names[:3] == ("world", "robot_world", "upper")
    assert any("the link 'world' is called 'robot_world' here" in note for note in arm.notes)
    assert arm.joints[0].pose.translation[2] == 1


def test_a_bundled_gripper_goes_on_an_imported_arm(tmp_path):
    write_arm(tmp_path)
    arm = load_arm(tmp_path, gripper="rh_p12_rn_a")
    assert arm.tcp_link == "end_effector_link"
    assert arm.groups["manipulator"].tip_link == "end_effector_link"
    assert arm.gripper is not None


def test_what_is_ignored_or_assumed_is_noted(tmp_path):
    extra = "<gazebo/><gazebo/><transmission/></robot>"
    urdf = URDF.replace("</robot>", extra).replace('velocity="0.3"', 'velocity="0"')
    write_arm(tmp_path, urdf, SRDF.replace('value="0.7"', 'value="7"'))
    arm = load_arm(tmp_path)
    assert arm.notes == (
        "2 <gazebo> elements ignored",
        "1 <transmission> element ignored",
        "joint reach: the velocity limit of 0 counts as none",
        "SRDF: state 'home' has bend at 7, outside its limits [-2, 2]",
        "no velocity limits of reach: 0.2 m/s is assumed",
        "no acceleration limits: 5 rad/s^2 and 1 m/s^2 are assumed",
    )


def test_the_range_of_a_continuous_joint_is_noted(tmp_path):
    text = URDF.replace('<limit velocity="2"', '<limit lower="-1" upper="1" velocity="2"')
    write_arm(tmp_path, text)
    assert load_arm(tmp_path).notes[0] == (
        "joint turn: `lower` and `upper` are ignored, since the type is continuous;"
        " `revolute` has them"
    )
    write_arm(tmp_path, text.replace('lower="-1" upper="1" vel', 'lower="0" upper="0" vel'))
    assert not any("ignored" in note for note in load_arm(tmp_path).notes)


def test_a_state_may_place_joints_of_several_axes_that_stand_still_here(tmp_path):
    several = '<joint name="held" value="0 0 1"/><joint name="tip" value="0 0 0 0 0 0 1"/>'
    write_arm(tmp_path, srdf=SRDF.replace("</group_state>", f"{several}</group_state>"))
    arm = load_arm(tmp_path)
    assert arm.states_of("manipulator")["home"].positions["bend"] == 0.7
    assert "SRDF: state 'home' places 'tip', which is fixed: ignored" in arm.notes
    write_arm(tmp_path, srdf=SRDF.replace('value="0.7"', 'value="0.7 0"'))
    with pytest.raises(SpecError, match=r"arm.srdf:6:31: state 'home': joint 'bend' has one"):
        load_arm(tmp_path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"urdf": "arn.urdf"}, ["robot.urdf", "arn.urdf", "did you mean 'arm.urdf'"]),
        ({"srdf": "gone.srdf"}, ["robot.srdf: there is no file"]),
        ({"packages": ["gone"]}, ["robot.packages: there is no folder"]),
        ({"group": "manipulater"}, ["robot.group", "did you mean `manipulator`"]),
        ({"tcp_link": "tol"}, ["robot.tcp_link", "did you mean `tool`"]),
        ({"urdf": "package://gone/arm.urdf"}, ["robot.urdf", "package 'gone' is not found"]),
    ],
)
def test_an_option_that_does_not_fit_is_reported_with_the_way_out(tmp_path, options, words):
    write_arm(tmp_path)
    with pytest.raises(RobotError) as caught:
        load_arm(tmp_path, **options)
    for word in words:
        assert word in str(caught.value)


def test_links_in_each_other_at_the_start_are_allowed_where_no_srdf_says(tmp_path):
    wide = URDF.replace('radius="0.03" length="0.14"', 'radius="0.03" length="0.5"')
    write_arm(tmp_path, wide)
    arm = load_arm(tmp_path, srdf=None)
    assert arm.allowed_collisions["upper", "wrist"] == "Default"
    assert any("touch at the start are allowed: upper - wrist" in note for note in arm.notes)


def test_pieces_at_one_joint_that_touch_at_the_start_are_allowed_too(tmp_path):
    cover = f'<link name="cover">{INERTIAL}{SHAPE}</link><joint name="screw" type="fixed">'
    cover += '<parent link="upper"/><child link="cover"/></joint>'
    joint = '<joint name="bend"'
    wide = URDF.replace('radius="0.03" length="0.14"', 'radius="0.03" length="0.3"')
    assert joint in wide
    write_arm(tmp_path, wide.replace(joint, cover + joint))
    arm = load_arm(tmp_path, srdf=None)
    assert arm.allowed_collisions["lower", "upper"] == "Adjacent"
    assert arm.allowed_collisions["cover", "lower"] == "Default"


@pytest.mark.parametrize("effort", [30, 7, 5])
def test_an_arm_of_small_efforts_moves_as_slowly_as_they_require(tmp_path, effort):
    write_arm(tmp_path, URDF.replace('velocity="2" effort="30"', f'velocity="2" effort="{effort}"'))
    assert load_arm(tmp_path).joint_by_name["bend"].acceleration == 5
    result, _ = run(
        tmp_path,
        "- move_to: {joints: {turn: 0.8, bend: -1.2}}",
        robot="{urdf: arm.urdf, srdf: arm.srdf}",
        rest="expect: [{always: within_limits}, tracking_error]",
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


def test_a_joint_that_gravity_is_too_much_for_is_reported(tmp_path):
    write_arm(tmp_path, URDF.replace('velocity="2" effort="30"', 'velocity="2" effort="3"'))
    assert any("'bend' cannot hold the arm everywhere" in note for note in load_arm(tmp_path).notes)


def test_a_joint_without_effort_limit_is_written_so_that_others_read_it(tmp_path):
    write_arm(tmp_path, URDF.replace(' effort="30"/>', "/>"))
    arm = load_arm(tmp_path)
    assert np.isinf(arm.joint_by_name["bend"].effort)
    assert pin.buildModelFromXML(arm.urdf).nq == 4  # a continuous joint has two numbers
    assert np.isinf(parse_urdf(arm.urdf, tmp_path, "again").joints[2].effort)


def test_a_mimic_is_followed_in_planning_and_in_physics(tmp_path):
    mimic = '<mimic joint="bend" multiplier="0.1" offset="0.05"/><limit lower="0"'
    write_arm(tmp_path, URDF.replace('<limit lower="0"', mimic), SRDF.replace("reach", "bend", 1))
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names == ("turn", "bend")
    steps = "- move_to: {joints: {turn: 1.2, bend: 0.9}}"
    result, saved = run(tmp_path, steps, robot="{urdf: arm.urdf}")
    assert result.outcome == "passed"
    _, bend, reach = saved.signals.joint_positions.T
    assert np.abs(reach - (0.1 * bend + 0.05)).max() < 2e-3
    positions = arm.with_mimics(np.array([1.2, 0.9, 0.0]))
    planned = PinocchioKinematics(arm).link_pose(positions, "tool").translation
    assert saved.signals.tcp_pose[-1, :3] == pytest.approx(planned, abs=3e-3)


def test_an_imported_arm_is_carried_by_feed_forward(tmp_path):
    write_arm(tmp_path, URDF.replace('<mass value="1"/>', '<mass value="3"/>'))
    steps = "- move_to: {joints: {turn: 2.0, bend: 1.5, reach: 0.15}}"
    result, saved = run(tmp_path, steps, robot="{urdf: arm.urdf, srdf: arm.srdf}")
    assert result.outcome == "passed"
    errors = np.abs(saved.signals.joint_positions - saved.signals.joint_commands)
    efforts = np.abs(saved.signals.joint_efforts).max(axis=0)
    assert efforts[1] > 5, "gravity pulls"
    assert np.nanmax(errors) < 1e-3


@pytest.mark.parametrize(("damping", "velocity"), [("0", 2), ("5", 2), ("10", 1.5), ("100", 0.15)])
def test_damping_leaves_half_of_the_effort_at_the_velocity_limit(tmp_path, damping, velocity):
    """A motion at a velocity whose damping exceeds the effort limit could not be followed."""
    limit = '<limit lower="-2" upper="2" velocity="2" effort="30"/>'
    damped = URDF.replace(limit, f'{limit}<dynamics damping="{damping}"/>')
    assert damped != URDF
    write_arm(tmp_path, damped)
    arm = load_arm(tmp_path)
    assert arm.joint_by_name["bend"].velocity == pytest.approx(velocity)
    reported = any("'bend': its damping takes" in note for note in arm.notes)
    assert reported == (velocity < 2)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            {"model": "arm.sdf"},
            "a robot of your own is named by its file: `robot: {sdf: FILE}`",
        ),
        ({"urdf": "arm.sdf"}, "a robot in SDF is named by `sdf`"),
        ({"sdf": "arm.xml"}, "the root element is <mujoco>; that of an SDF file is <sdf>"),
        ({"urdf": "arm.xml"}, "a robot in MJCF is named by `mjcf`"),
    ],
)
def test_a_known_format_in_the_wrong_place_is_named(tmp_path, words, message):
    (tmp_path / "arm.sdf").write_text('<sdf version="1.9"><model name="a"/></sdf>')
    (tmp_path / "arm.xml").write_text('<mujoco model="a"/>')
    with pytest.raises((RobotError, SpecError)) as caught:
        load_robot(RobotSpec.model_validate(words), tmp_path)
    assert message in str(caught.value)
