"""The gripper that an imported arm brings: recognised from its SRDF, or named."""

import math
import shutil
from itertools import pairwise

import numpy as np
import pytest

from docs import ROOT
from harness.cell.approach import approach_axis
from harness.core.errors import RobotError, SpecError
from harness.core.spatial import rotation_from_quat_wxyz
from harness.language.scenario import RobotSpec
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.robot.load import load_robot
from harness.robot_tools.robot_check import check_robot
from harness.robot_tools.robot_findings import states
from tests.engine.front_door import check, run
from tests.planning.seven_joints import SRDF as SEVEN_SRDF
from tests.planning.seven_joints import seven_joint_urdf
from tests.robot.arm_files import INERTIAL, SRDF, URDF, load_arm, write_arm

PALM = f"""  <link name="palm">{INERTIAL}</link>
  <joint name="palm_joint" type="fixed"><parent link="tool"/><child link="palm"/></joint>
"""
FINGER = """  <link name="{name}"><inertial><mass value="0.05"/>
    <inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/></inertial>
    <collision><origin xyz="0 {y} 0.05"/><geometry><box size="0.02 0.01 0.06"/></geometry>
    </collision></link>
  <joint name="{name}_joint" type="prismatic"><parent link="palm"/><child link="{name}"/>
    <axis xyz="0 {side} 0"/><limit lower="0" upper="0.03" velocity="0.1" effort="40"/>{mimic}
  </joint>
"""
LEFT = FINGER.format(name="left", y=0.01, side=1, mimic="")
RIGHT = FINGER.format(name="right", y=-0.01, side=-1, mimic='<mimic joint="left_joint"/>')
HAND = PALM + LEFT + RIGHT
GROUP = """  <group name="hand"><joint name="left_joint"/></group>
  <end_effector name="grip" parent_link="tool" group="hand" parent_group="manipulator"/>
"""


LINKS = ("base_link", "a", "b", "c", "d", "e", "tool")
AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1")
SIX = (
    '<robot name="six">'
    + "".join(f'<link name="{name}">{INERTIAL}</link>' for name in LINKS)
    + "".join(
        f'<joint name="{after}_joint" type="revolute"><parent link="{before}"/>'
        f'<child link="{after}"/><origin xyz="0 0 0.15"/><axis xyz="{axis}"/>'
        '<limit lower="-3" upper="3" velocity="2" effort="100"/></joint>'
        for (before, after), axis in zip(pairwise(LINKS), AXES, strict=True)
    )
    + HAND
    + "</robot>"
)
SIX_SRDF = f"""<robot name="six">
  <group name="manipulator"><chain base_link="base_link" tip_link="tool"/></group>
{GROUP}</robot>
"""


def write(folder, hand=HAND, group=GROUP):
    end = "</robot>"
    write_arm(folder, URDF.replace(end, hand + end), SRDF.replace(end, group + end))


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


FRAME = """<link name="{0}">{2}</link><joint name="g" type="fixed"><parent link="palm"/>
    <child link="{0}"/><origin xyz="{1}" rpy="0 0 1"/></joint>"""
LIGHT = """<inertial><mass value="0.001"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6"/></inertial>"""


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


PALM_AT_THE_TIPS = f"""  <link name="palm">{INERTIAL}<collision><origin xyz="0 0 -0.09"/>
    <geometry><box size="0.06 0.08 0.08"/></geometry></collision></link>
  <joint name="palm_joint" type="fixed"><parent link="tool"/><child link="palm"/>
    <origin xyz="0 0 0.14"/></joint>
"""
TIPS = PALM_AT_THE_TIPS + (LEFT + RIGHT).replace(' 0.05"/>', ' -0.03"/>')
"""The palm, and with it the fingers, have their origins where the fingers end."""


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


UNCOUPLED = HAND.replace('<mimic joint="left_joint"/>', "")
JAW = PALM.replace(
    "</link>",
    """<collision><origin xyz="0 -0.025 0.05"/><geometry><box size="0.03 0.01 0.1"/></geometry>
    </collision></link>""",
    1,
) + FINGER.format(name="jaw", y=0.0, side=1, mimic="").replace(
    'upper="0.03"', 'upper="0.05"'
).replace('lower="0"', 'lower="-0.015"')


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
        (JAW, "jaw_joint", 0.065),
    ],
    ids=["coupled", "alike", "mirrored", "mirrored, of unlike ranges", "three fingers", "one jaw"],
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


FLAT = (
    '<link name="{0}"><inertial><mass value="0.05"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/>'
    '</inertial><collision><origin xyz="0 {1} 0.05"/><geometry><box size="0.04 0.02 0.1"/>'
    "</geometry></collision></link>"
)
TURNING_JAW = (
    PALM.replace(f'<link name="palm">{INERTIAL}</link>', FLAT.format("palm", -0.01))
    + FLAT.format("jaw", 0.01)
    + '<joint name="jaw_joint" type="revolute"><parent link="palm"/><child link="jaw"/>'
    '<axis xyz="-1 0 0"/><limit lower="0" upper="1.2" velocity="1" effort="2"/></joint>'
)
"""As on the SO-101: the jaw lies on the palm when closed, and turns about its lower edge."""


def test_the_opening_of_a_jaw_that_always_touches_at_its_hinge_is_that_of_its_outer_half(tmp_path):
    write(tmp_path, TURNING_JAW, group="")
    gripper = load_arm(tmp_path, srdf=None).gripper
    assert (gripper.closed_position, gripper.widths[0, 1]) == pytest.approx((0, 0), abs=1e-6)
    corner = 0.05 * math.sin(1.2)
    assert gripper.widths[-1, 1] == pytest.approx(corner, rel=0.05)


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


def test_a_wrist_that_ends_an_arm_is_no_jaw(tmp_path):
    write_arm(tmp_path)
    assert load_arm(tmp_path, srdf=None).groups["arm"].joint_names == ("turn", "bend", "reach")
    assert load_arm(tmp_path, srdf=None).gripper is None


SHAPE = """<collision><origin xyz="0.03 0 0.05"/><geometry><box size="0.08 0.06 0.1"/></geometry>
    </collision>"""


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


SIX_WITH_JAW = SIX.replace(HAND, JAW)
SIX_WITH_TURNING_JAW = SIX.replace(HAND, TURNING_JAW)
FIVE_WITH_TURNING_JAW = (
    SIX_WITH_TURNING_JAW.replace('name="d_joint" type="revolute"', 'name="d_joint" type="fixed"')
    .replace("</robot>", FRAME.format("jaw_tip_tcp", "0.002 0 0.09", "") + "</robot>")
    .replace('rpy="0 0 1"', 'rpy="0 0 1.2"')
)
"""The TCP's z axis points out of the hand, its x axis across it."""
BLOCK = """
    objects:
      - name: block
        pose: {xyz: [0.3, 0.1, 0.03]}
        box: {size: [0.03, 0.04, 0.06]}
        mass: 0.05
    expect:
      - grasped: {object: block, during: pick}
"""
PICK = "- {pick: {object: block, approach: {distance: 0.05}, lift: {distance: 0.05}}, id: pick}"


def test_a_single_jaw_closes_an_object_on_the_palm(tmp_path):
    assert SIX_WITH_JAW != SIX
    write_arm(tmp_path, SIX_WITH_JAW)
    result, saved = run(tmp_path, PICK, robot="{urdf: arm.urdf}", rest=BLOCK)
    assert result.outcome == "passed", [step.message for step in result.steps]
    height = saved.signals.object_poses["block"][:, 2]
    assert height[-1] - height[0] > 0.045


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


BLOCK_AT = """<collision><origin xyz="{}"/><geometry><box size="0.02 0.06 0.06"/></geometry>
    </collision>"""


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
