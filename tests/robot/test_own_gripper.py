"""The gripper that an imported arm brings: recognised from its SRDF, or named."""

import math
import shutil

import numpy as np
import pytest

from docs import ROOT
from harness.cell.approach import approach_axis
from harness.core.errors import RobotError, SpecError
from harness.language.scenario import RobotSpec
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.authoring.robot_check import check_robot
from harness.robot.load import load_robot
from tests.robot.arm_files import SRDF, URDF, load_arm, write_arm
from tests.robot.hands import (
    FINGER,
    FRAME,
    GROUP,
    HAND,
    JAW,
    LEFT,
    LIGHT,
    PALM,
    SHAPE,
    SIX,
    TIP,
    TIPS,
    TURNING_JAW,
    UNCOUPLED,
    write,
)


def test_the_end_effector_of_the_srdf_is_the_gripper(tmp_path):
    write(tmp_path)
    arm = load_arm(tmp_path)
    gripper = arm.gripper
    assert (gripper.group, gripper.joint, gripper.palm_link) == ("hand", "left_joint", "palm")
    assert list(gripper.pads.values()) == ["left", "right"]
    assert (gripper.open_position, gripper.closed_position) == (0.03, 0.0)
    # Inner faces stand 5 mm off the middle, and each finger moves with the joint.
    assert gripper.widths[:, 1] == pytest.approx(0.01 + 2 * gripper.widths[:, 0], abs=1e-6)
    assert gripper.grip_effort == pytest.approx(40, rel=1e-3), "20 N on each of two pads"
    assert arm.allowed_collisions["left", "right"] == "Gripper"


def test_the_tcp_is_halfway_between_the_pads(tmp_path):
    write(tmp_path)
    arm = load_arm(tmp_path)
    assert arm.tcp_link == "hand_tcp"
    assert arm.groups["manipulator"].tip_link == "hand_tcp"
    assert arm.joint_by_name["hand_tcp_joint"].pose.translation == pytest.approx([0, 0, 0.05])


@pytest.mark.parametrize(
    ("name", "place", "inertial"),
    [
        ("grasp_point", "0 0 0.06", ""),
        ("link_tcp", "0 0 0.081", ""),
        ("hand_tcp", "0 0 0.068", ""),
        ("ee_gripper_link", "0 0.001 0.062", LIGHT),
        ("between", "0 0 0.045", ""),
    ],
)
def test_a_frame_at_the_pads_is_the_tcp_where_there_is_one(tmp_path, name, place, inertial):
    write(tmp_path, HAND + FRAME.format(name, place, inertial))
    arm = load_arm(tmp_path)
    assert arm.tcp_link == name
    assert arm.groups["manipulator"].tip_link == name
    assert any(note.startswith(f"TCP: '{name}', ") for note in arm.notes)
    assert load_arm(tmp_path, tcp_link="tool").tcp_link == "tool"


def test_the_parent_of_the_end_effector_is_the_tcp_if_it_is_at_the_pads(tmp_path):
    """xArm's SRDF names the TCP there, MoveIt's assistant the flange."""
    frames = FRAME.format("between", "0 0 0.05", "") + FRAME.format(
        "point", "0 0 0.09", ""
    ).replace('"g"', '"h"')
    write(tmp_path, HAND + frames, GROUP.replace('parent_link="tool"', 'parent_link="point"'))
    assert load_arm(tmp_path).tcp_link == "point"
    write(tmp_path, HAND + frames)
    assert load_arm(tmp_path).tcp_link == "between"


MARKER = '<visual><geometry><box size="0.01 0.01 0.01"/></geometry></visual>'


@pytest.mark.parametrize("name", ["end_effector_link", "ee_link", "grasp_frame"])
@pytest.mark.parametrize("options", [{}, {"srdf": None}])
def test_a_frame_with_a_visible_marker_is_the_tcp(tmp_path, name, options):
    write(tmp_path, HAND + FRAME.format(name, "0 0 0.073", MARKER))
    arm = load_arm(tmp_path, **options)
    assert arm.tcp_link == name
    assert any(
        note == f"TCP: '{name}', 23 mm from the middle between the pads" for note in arm.notes
    )


def test_the_parent_of_an_end_effector_without_a_parent_group_is_the_tcp(tmp_path):
    frame = FRAME.format("point", "0 0 0.08", LIGHT + MARKER)
    tool = '<end_effector name="e" parent_link="point" group="hand"/>'
    write(tmp_path, HAND + frame, GROUP.splitlines()[0] + tool)
    assert load_arm(tmp_path).tcp_link == "point"


def approach(arm):
    state = arm.with_mimics(arm.start_positions())
    axis = approach_axis(arm, PinocchioKinematics(arm), CoalScene(arm), state)
    return axis / np.linalg.norm(axis)


def test_a_gripper_approaches_from_the_body_of_its_palm_to_the_pads(tmp_path):
    write(tmp_path, TIPS)
    arm = load_arm(tmp_path)
    assert arm.tcp_link == "hand_tcp"
    assert approach(arm) == pytest.approx([0, 0, 1])
    assert approach(load_arm(tmp_path, tcp_link="palm")) == pytest.approx([0, 0, 1])
    report = check_robot(arm, "arm.urdf", samples=20).report
    assert report.gripper.endswith("; approaches along +z of hand_tcp")


@pytest.mark.parametrize("shift", [(0.012, 0.0), (0.0, -0.015), (0.01, 0.01)])
@pytest.mark.parametrize(
    "body", ["", "<collision><geometry><box size='0.04 0.06 0.02'/></geometry>"]
)
def test_a_palm_with_its_origin_next_to_the_hand_does_not_tilt_the_approach(tmp_path, shift, body):
    x, y = shift
    hand = HAND.replace('<child link="palm"/>', f'<child link="palm"/><origin xyz="{-x} {-y} 0"/>')
    for side in (0.01, -0.01):
        hand = hand.replace(f'"0 {side} 0.05"', f'"{x} {side + y} 0.05"')
    shape = f"{body}<origin xyz='{x} {y} 0'/></collision></link>" if body else "</link>"
    write(tmp_path, hand.replace("</link>", shape, 1))
    assert approach(load_arm(tmp_path)) == pytest.approx([0, 0, 1])


@pytest.mark.parametrize("tilt", [0.5, -0.7])
def test_a_hand_that_is_mounted_obliquely_approaches_obliquely(tmp_path, tilt):
    hand = HAND.replace('<child link="palm"/>', f'<child link="palm"/><origin rpy="0 {tilt} 0"/>')
    write(tmp_path, hand)
    assert approach(load_arm(tmp_path)) == pytest.approx([math.sin(tilt), 0, math.cos(tilt)])


def test_a_tip_that_the_srdf_states_at_the_pads_is_the_tcp_though_it_has_shapes(tmp_path):
    write(tmp_path, TIPS, GROUP.replace('parent_link="tool"', 'parent_link="palm"'))
    arm = load_arm(tmp_path)
    assert (arm.tcp_link, arm.groups["manipulator"].tip_link) == ("palm", "palm")
    srdf = SRDF.replace('tip_link="tool"', 'tip_link="palm"')
    write_arm(tmp_path, (tmp_path / "arm.urdf").read_text(encoding="utf-8"), srdf)
    assert load_arm(tmp_path).tcp_link == "palm"


def test_a_robot_yaml_may_state_the_approach_axis(tmp_path):
    folder = shutil.copytree(ROOT / "robots/open_manipulator_x", tmp_path / "arm")
    text = (folder / "robot.yaml").read_text(encoding="utf-8")
    stated = text.replace("\ngripper:\n", "\ngripper:\n  approach_axis: [0, 0, -2]\n")
    (folder / "robot.yaml").write_text(stated, encoding="utf-8")
    assert approach(load_robot(RobotSpec(model="arm"), tmp_path)) == pytest.approx([0, 0, -1])
    (folder / "robot.yaml").write_text(stated.replace("-2]", "0]"), encoding="utf-8")
    with pytest.raises(SpecError, match=r"approach_axis: .*no direction"):
        load_robot(RobotSpec(model="arm"), tmp_path)


@pytest.mark.parametrize(
    ("name", "place"), [("flange_tcp", "0 0 0.01"), ("tcp", "0 0 0.2"), ("other", "0 0.04 0.05")]
)
def test_a_frame_that_is_not_at_the_pads_is_no_tcp(tmp_path, name, place):
    write(tmp_path, HAND + FRAME.format(name, place, ""))
    arm = load_arm(tmp_path)
    assert arm.tcp_link == "hand_tcp"
    note = "TCP: no frame is between the pads; 'hand_tcp' is added there, 50 mm from 'tool'"
    assert note in arm.notes


def test_naming_the_gripper_does_not_change_the_tcp(tmp_path):
    write(tmp_path, HAND + FRAME.format("tcp", "0 0 0.07", ""), GROUP.splitlines()[0])
    named, found = load_arm(tmp_path, gripper="hand"), load_arm(tmp_path)
    assert named.tcp_link == found.tcp_link == "tcp"
    assert named.gripper.joint == found.gripper.joint


def test_the_tcp_of_an_arm_of_joints_is_a_frame_of_that_name(tmp_path):
    """A group of joints states no tip; a chain does."""
    frame = FRAME.format("tool_tcp", "0 0 0.1", "")
    joints = '<joint name="turn"/><joint name="bend"/><joint name="reach"/>'
    chain = '<chain base_link="base_link" tip_link="tool"/>'
    write_arm(tmp_path, URDF.replace("</robot>", PALM + frame + "</robot>"), SRDF)
    assert load_arm(tmp_path).tcp_link == "tool"
    write_arm(tmp_path, srdf=SRDF.replace(chain, joints), urdf=(tmp_path / "arm.urdf").read_text())
    assert load_arm(tmp_path).tcp_link == "tool_tcp"


def test_two_alike_fingers_without_a_mimic_are_coupled(tmp_path):
    both = '<group name="hand"><joint name="left_joint"/><joint name="right_joint"/></group>'
    group = GROUP.replace('<group name="hand"><joint name="left_joint"/></group>', both)
    write(tmp_path, HAND.replace('<mimic joint="left_joint"/>', ""), group)
    arm = load_arm(tmp_path)
    assert arm.joint_by_name["right_joint"].mimic.joint == "left_joint"
    assert "gripper 'hand': right_joint is made to follow left_joint" in arm.notes


@pytest.mark.parametrize(
    ("hand", "joint", "opening"),
    [
        (HAND, "left_joint", 0.07),
        (UNCOUPLED, "left_joint", 0.07),
        (
            UNCOUPLED.replace(
                '<axis xyz="0 -1 0"/><limit lower="0" upper="0.03"',
                '<axis xyz="0 1 0"/><limit lower="-0.03" upper="0"',
            ),
            "left_joint",
            0.07,
        ),
        (
            UNCOUPLED.replace(
                '<axis xyz="0 -1 0"/><limit lower="0" upper="0.03"',
                '<axis xyz="0 1 0"/><limit lower="-0.02" upper="0"',
            ),
            "left_joint",
            0.05,
        ),
        (UNCOUPLED + LEFT.replace("left", "thumb"), "left_joint", 0.07),
        (UNCOUPLED + TIP.format("left") + TIP.format("right"), "left_joint", 0.07),
        (JAW, "jaw_joint", 0.065),
    ],
    ids=[
        "coupled",
        "alike",
        "mirrored",
        "mirrored, of unlike ranges",
        "three fingers",
        "two joints each",
        "one jaw",
    ],
)
def test_a_gripper_is_found_without_an_srdf(tmp_path, hand, joint, opening):
    write(tmp_path, hand)
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names == ("turn", "bend", "reach")
    assert (arm.gripper.joint, arm.gripper.group) == (joint, "gripper")
    assert arm.gripper.widths[:, 1].max() == pytest.approx(opening, abs=1e-6)
    assert arm.groups["gripper"].joint_names == (joint,)


def test_the_last_joint_of_a_robot_that_is_a_finger_is_no_jaw(tmp_path):
    urdf = URDF
    for name in ("turn", "bend", "reach"):
        urdf = urdf.replace(f'name="{name}"', f'name="finger_{name}"')
    write_arm(tmp_path, urdf)
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names == ("finger_turn", "finger_bend", "finger_reach")
    assert arm.gripper is None


def test_the_opening_of_a_jaw_that_always_touches_at_its_hinge_is_that_of_its_outer_half(tmp_path):
    write(tmp_path, TURNING_JAW, group="")
    gripper = load_arm(tmp_path, srdf=None).gripper
    assert (gripper.closed_position, gripper.widths[0, 1]) == pytest.approx((0, 0), abs=1e-6)
    corner = 0.05 * math.sin(1.2)
    assert gripper.widths[-1, 1] == pytest.approx(corner, rel=0.05)


@pytest.mark.parametrize(
    ("height", "inward"), [(0.03, 0.008), (0.035, 0.004), (0.04, 0.008), (0.04 + 1e-10, 0.004)]
)
def test_the_opening_of_fingers_that_slide_is_the_gap_at_their_pads(tmp_path, height, inward):
    """Each finger has a carriage at its root, which extends farther inward than its pad."""
    hand = HAND
    for side in (1, -1):
        carriage = (
            f'<collision><origin xyz="0 {side * (0.01 - inward)} {height}"/>'
            '<geometry><box size="0.02 0.01 0.02"/></geometry></collision></link>\n'
            f'  <joint name="{"left" if side > 0 else "right"}_joint" type="prismatic"'
        )
        hand = hand.replace("</link>\n" + carriage.split("</link>\n")[1], carriage)
    assert hand.count("<collision>") == 4
    write(tmp_path, hand)
    gripper = load_arm(tmp_path).gripper
    assert gripper.widths[:, 1] == pytest.approx(0.01 + 2 * gripper.widths[:, 0], abs=1e-6)


def test_a_gripper_has_states_open_and_close_even_if_no_srdf_names_them(tmp_path):
    write(tmp_path)
    states = load_arm(tmp_path, srdf=None).states_of("gripper")
    ends = {name: dict(state.positions) for name, state in states.items()}
    assert ends == {"open": {"left_joint": 0.03}, "close": {"left_joint": 0.0}}
    state = '<group_state name="Opened" group="hand"><joint name="left_joint" value="0.02"/>'
    write(tmp_path, group=f"{GROUP}{state}</group_state>")
    assert set(load_arm(tmp_path).states_of("hand")) == {"Opened", "close"}


def test_fingers_that_no_group_names_are_found_too(tmp_path):
    write(tmp_path, group="")
    assert load_arm(tmp_path).gripper.group == "gripper"


def test_a_wheel_of_the_motor_next_to_the_fingers_is_not_part_of_the_arm(tmp_path):
    wheel = FINGER.format(name="wheel", y=0, side=1, mimic="").replace("prismatic", "continuous")
    (tmp_path / "arm.urdf").write_text(SIX.replace("</robot>", wheel + "</robot>"))
    arm = load_robot(RobotSpec(urdf="arm.urdf"), tmp_path)
    assert arm.groups["arm"].joint_names[-1] == "tool_joint"
    assert (arm.gripper.joint, sorted(arm.gripper.pads.values())) == (
        "left_joint",
        ["left", "right"],
    )


@pytest.mark.parametrize("names", [("slider", "gripper_screw"), ("spindle", "finger_screw")])
def test_a_screw_on_a_slider_next_to_the_fingers_is_not_part_of_the_arm(names, tmp_path):
    """As of the PR2, whose model shows how the gripper's motor turns its screw."""
    slider, screw = (FINGER.format(name=name, y=0, side=1, mimic="") for name in names)
    screw = screw.replace("prismatic", "continuous").replace('link="palm"', f'link="{names[0]}"')
    (tmp_path / "arm.urdf").write_text(SIX.replace("</robot>", slider + screw + "</robot>"))
    arm = load_robot(RobotSpec(urdf="arm.urdf"), tmp_path)
    assert arm.groups["arm"].joint_names[-1] == "tool_joint"
    assert arm.gripper.joint == "left_joint"


def test_a_wrist_that_ends_an_arm_is_no_jaw(tmp_path):
    write_arm(tmp_path)
    assert load_arm(tmp_path, srdf=None).groups["arm"].joint_names == ("turn", "bend", "reach")
    assert load_arm(tmp_path, srdf=None).gripper is None


def test_a_whole_tool_that_a_wrist_turns_is_no_jaw_whatever_its_name(tmp_path):
    urdf = SIX.replace(HAND, "").replace('"tool"', '"gripper_base"')
    for link in ("e", "gripper_base"):
        urdf = urdf.replace(f'<link name="{link}">', f'<link name="{link}">{SHAPE}')
    write_arm(tmp_path, urdf)
    assert load_arm(tmp_path, srdf=None).groups["arm"].joint_names[-1] == "tool_joint"


def test_a_hand_whose_fingers_stand_still_is_no_part_of_the_arm(tmp_path):
    """As in Talos' left arm, where only the link at the gripper's motor turns."""
    crank = JAW.replace('name="jaw"', 'name="crank"').replace('"palm"', '"gripper_base"')
    crank = crank.replace('"jaw_joint"', '"gripper_joint"').replace('link="jaw"', 'link="crank"')
    write_arm(tmp_path, SIX.replace(HAND, crank.replace("0 1 0", "0 0 1")))
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names[-1] == "tool_joint"
    assert any(note.startswith("'gripper' is not used as a gripper: the gap") for note in arm.notes)


def test_a_jaw_without_shapes_is_no_joint_of_the_arm(tmp_path):
    """As in a description of the SO-100."""
    seen = JAW.replace("collision>", "visual>")
    write_arm(tmp_path, SIX.replace(HAND, seen))
    arm = load_arm(tmp_path, srdf=None)
    assert arm.groups["arm"].joint_names[-1] == "tool_joint"
    assert any("its fingers have no collision shapes" in note for note in arm.notes)


def test_a_named_group_is_the_gripper_without_an_end_effector(tmp_path):
    group = GROUP.splitlines()[0]
    write(tmp_path, group=group)
    assert load_arm(tmp_path).gripper.group == "hand"
    assert load_arm(tmp_path, gripper="hand").gripper.joint == "left_joint"


@pytest.mark.parametrize(
    ("hand", "words"),
    [
        (PALM + LEFT, "do not move towards each other"),
        (HAND.replace('axis xyz="0 -1 0"', 'axis xyz="0 1 0"'), "do not move towards each other"),
        (HAND.replace("<collision>", "<visual>").replace("</collision>", "</visual>"), "no coll"),
    ],
)
def test_a_hand_that_does_not_grasp_is_reported(tmp_path, hand, words):
    write(tmp_path, hand)
    assert any(words in note for note in load_arm(tmp_path).notes)
    with pytest.raises(RobotError, match="'hand' is not a gripper"):
        load_arm(tmp_path, gripper="hand")


@pytest.mark.parametrize("inside", ["", '<joint name="right_joint" value="0.01"/>'])
def test_a_state_of_the_hand_without_its_joint_is_left_out(tmp_path, inside):
    state = f'<group_state name="close" group="hand">{inside}</group_state>'
    write(tmp_path, group=GROUP + state)
    arm = load_arm(tmp_path)
    assert any("SRDF: 'close' of 'hand' left out" in note for note in arm.notes)
    states = arm.states_of("hand")
    assert states["close"].positions[arm.gripper.joint] == arm.gripper.closed_position


def test_a_state_of_the_scenario_places_the_joint_of_the_gripper(tmp_path):
    write(tmp_path)
    with pytest.raises(RobotError, match="it does not place 'left_joint' of the gripper"):
        load_arm(tmp_path, named_states={"hand": {"half": {}}})
