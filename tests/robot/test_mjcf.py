"""MJCF robots: the same links, joints and masses as MuJoCo has of the file."""

import re

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from harness.core.errors import RobotError, SpecError
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.robot.load import load_robot
from harness.simulation.servo import bare_robot
from tests.robot.mjcf_arm import LINKAGE, MJCF, TIP
from tests.session.front_door import run

JOINTS = ("pan", "lift", "elbow", "slide", "pinch")
LINKS = ("base", "upper", "lower", "wrist", "finger")


def write(folder, text=MJCF):
    (folder / "assets").mkdir(exist_ok=True)
    (folder / "assets" / "t.obj").write_text(TIP, encoding="utf-8")
    (folder / "arm.xml").write_text(text, encoding="utf-8")


def load(folder, **words):
    words = {"mjcf": "arm.xml", "tcp_link": "tcp", **words}
    return load_robot(RobotSpec.model_validate(words), folder)


def test_planner_physics_and_the_file_agree_on_every_body(tmp_path):
    write(tmp_path)
    arm = load(tmp_path)
    original = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    physics = bare_robot(arm).compile()
    kinematics = PinocchioKinematics(arm)
    rng = np.random.default_rng(3)
    for _ in range(5):
        positions = arm.with_mimics(rng.uniform(-0.5, 0.5, 5))
        there, here = mujoco.MjData(original), mujoco.MjData(physics)
        for name, value in zip(arm.joint_names, positions, strict=True):
            there.joint(name).qpos = here.joint(name).qpos = value
        mujoco.mj_kinematics(original, there)
        mujoco.mj_kinematics(physics, here)
        for link in LINKS:
            expected = there.body(link).xpos
            assert here.body(link).xpos == pytest.approx(expected, abs=1e-12)
            planned = kinematics.link_pose(positions, link).translation
            assert planned == pytest.approx(expected, abs=1e-12)
        assert kinematics.link_pose(positions, "tcp").translation == pytest.approx(
            there.site("tcp").xpos, abs=1e-12
        )


@pytest.mark.parametrize("name", ["world", "robot_world", "lower", "wrist"])
def test_a_site_with_the_name_of_a_body_or_the_world_is_renamed(tmp_path, name):
    """Sites and bodies have names of their own in MuJoCo, links have one name."""
    site = f'<site name="{name}" pos="0 0 0.3"/>'
    write(tmp_path, MJCF.replace('<body name="base">', f'<body name="base">{site}'))
    arm = load(tmp_path)
    assert any(f"the site '{name}' is called '{name}_site' here" in note for note in arm.notes)
    frame = PinocchioKinematics(arm).link_pose(arm.start_positions(), f"{name}_site")
    assert frame.translation == pytest.approx([0, 0, 0.3], abs=1e-12)


def test_a_site_at_the_frame_of_its_namesake_is_the_body(tmp_path):
    write(tmp_path, MJCF.replace('<body name="base">', '<body name="base"><site name="base"/>'))
    assert "base_site" not in load(tmp_path).link_names


def test_masses_are_those_that_mujoco_makes_of_the_geoms(tmp_path):
    write(tmp_path)
    arm = load(tmp_path)
    original = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    expected = sum(float(original.body(link).mass[0]) for link in LINKS)
    assert bare_robot(arm).compile().body_mass.sum() == pytest.approx(expected, abs=1e-12)
    model = pin.buildModelFromXML(arm.urdf)
    on_world = model.inertias[0].mass
    assert pin.computeTotalMass(model) + on_world == pytest.approx(expected, abs=1e-12)
    data, original_data = mujoco.MjData(bare_robot(arm).compile()), mujoco.MjData(original)
    mujoco.mj_forward(original, original_data)
    assert data.model.nv == 5 < original.nv == 11


def test_limits_efforts_states_and_pairs_are_read(tmp_path):
    write(tmp_path)
    arm = load(tmp_path)
    joints = arm.joint_by_name
    assert [joints[name].kind for name in JOINTS] == [
        "continuous", "revolute", "revolute", "prismatic", "prismatic",
    ]  # fmt: skip
    assert [joints[name].effort for name in JOINTS] == [50, 60, 30, np.inf, np.inf]
    assert joints["lift"].upper == pytest.approx(np.radians(100))
    assert (joints["pinch"].mimic.joint, joints["pinch"].mimic.multiplier) == ("slide", 0.4)
    assert joints["pinch"].mimic.offset == 0.01
    assert arm.states_of("arm")["home"].positions["elbow"] == 0.7
    assert arm.start_state["lift"] == 0.5
    assert arm.allowed_collisions["base", "lower"] == "Excluded"
    assert arm.notes[:4] == (
        "body 'upper' has 2 joints: links are put between them",
        "bodies that are free, or that no actuator moves, are left out: cube",
        "3 actuators are not used: the program drives every joint with its own servo",
        "1 geoms of the world body are not part of the robot",
    )


def test_a_mocap_base_that_carries_the_arm_is_fixed(tmp_path):
    write(tmp_path, MJCF.replace('<body name="base">', '<body name="base" mocap="true">'))
    arm = load(tmp_path)
    assert arm.joint_names == tuple(JOINTS)
    assert "body 'base' is a mocap body that carries joints: it is fixed" in arm.notes


def test_an_mjcf_arm_moves(tmp_path):
    write(tmp_path)
    robot = "{mjcf: arm.xml, tcp_link: tcp, base: {xyz: [0, 0, 0.5]}}"
    steps = """
        - move_to: {joints: {pan: 1.0, elbow: -0.5, slide: 0.05}}
        - move_to: home
    """
    result, saved = run(tmp_path, steps, robot=robot, rest="expect: [{always: within_limits}]")
    assert result.outcome == "passed", [step.message for step in result.steps]
    assert saved.signals.joint_positions[-1][:4] == pytest.approx([0.1, 0.5, 0.7, 0.02], abs=0.01)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("</mujoco>", "</mujocoo>", ["arm.xml:37:3", "not well-formed"]),
        ('<mujoco model="arm">', "<!DOCTYPE m><mujoco>", ["arm.xml:1:12", "DOCTYPE"]),
        ('file="t.obj"', 'file="gone.obj"', ["arm.xml:3:33", "gone.obj", "not there"]),
        ('file="t.obj"', 'file="/etc/passwd"', ["arm.xml:3:33", "outside"]),
        ("<equality>", '<include file="arm.xml"/><equality>', ["circle", "arm.xml - arm.xml"]),
        ("<equality>", "<extension/><equality>", ["plugins are not loaded"]),
        ('type="sphere" size="0.01"', 'type="sphere" size="-1"', ["arm.xml", "MuJoCo:"]),
        ('axis="0 0 1" range="0 0.1"', 'axis="0 0 1"', ["arm.xml:16:14", "has no range"]),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_at_its_place(tmp_path, old, new, words):
    assert old in MJCF
    write(tmp_path, MJCF.replace(old, new))
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize("moments", ["0 0 0", "0 1e-4 1e-4", "1e-4 0 1e-4"])
def test_a_fixed_body_without_inertia_gets_the_least_possible(tmp_path, moments):
    """MuJoCo accepts zero moments where a joint moves the body together with others."""
    plate = f"""<body name="plate"><inertial pos="0 0 0" mass="0.1" diaginertia="{moments}"/>
      <geom type="box" size="0.02 0.02 0.01"/></body>"""
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>'
    text = f"""<mujoco><worldbody><body name="a">{inertial}<joint name="j" range="-1 1"/>
      <geom type="box" size="0.05 0.05 0.05"/>{plate}</body></worldbody></mujoco>"""
    (tmp_path / "arm.xml").write_text(text)
    arm = load_robot(RobotSpec.model_validate({"mjcf": "arm.xml"}), tmp_path)
    assert any(note.startswith("link 'plate': no body has") for note in arm.notes)
    assert bare_robot(arm).compile().body("plate").mass == pytest.approx(0.1)


FINGERS = """<mujoco><compiler angle="radian"/><worldbody><body name="a">
  <joint name="turn" axis="0 0 1" range="-1 1"/><geom type="box" size="0.02 0.02 0.05"/>
  <body name="b" pos="0 0 0.3"><joint name="bend" axis="0 1 0" range="-1 1"/>
    <geom type="box" size="0.02 0.02 0.05"/>
  <body name="c" pos="0 0 0.3"><joint name="roll" axis="0 0 1" range="-1 1"/>
    <geom type="box" size="0.02 0.02 0.05"/><site name="pinch" pos="0 0 0.16"/>
  <body name="left" pos="0 0.01 0.1"><joint name="l" type="slide" axis="0 1 0" range="0 0.04"/>
    <geom type="box" size="0.01 0.005 0.03" pos="0 0 0.04"/></body>
  <body name="right" pos="0 -0.01 0.1"><joint name="r" type="slide" axis="0 {axis} 0" {range}/>
    <geom type="box" size="0.01 0.005 0.03" pos="0 0 0.04"/></body>
  </body></body></body></worldbody>
  <tendon><fixed name="both"><joint joint="l" coef="{coef}"/><joint joint="r" coef="{other}"/>
  </fixed></tendon>
  <actuator><position name="grip" tendon="both" forcerange="-60 60" kp="100"/></actuator>
  {more}</mujoco>"""
EQUAL = '<equality><joint joint1="r" joint2="l" polycoef="0 {0} 0 0 0"/></equality>'


@pytest.mark.parametrize(
    ("axis", "limits", "coef", "other", "more", "multiplier", "effort"),
    [
        (-1, "0 0.04", 0.5, 0.5, "", 1.0, 30),
        (1, "-0.04 0", 0.25, -0.25, "", -1.0, 15),
        (-1, "0 0.04", 0.5, 0.5, EQUAL.format(1), 1.0, 30),
    ],
)
def test_fingers_on_one_tendon_are_a_gripper_and_a_site_its_tcp(
    tmp_path, axis, limits, coef, other, more, multiplier, effort
):
    text = FINGERS.format(axis=axis, range=f'range="{limits}"', coef=coef, other=other, more=more)
    (tmp_path / "arm.xml").write_text(text)
    arm = load_robot(RobotSpec.model_validate({"mjcf": "arm.xml"}), tmp_path)
    assert arm.groups["arm"].joint_names == ("turn", "bend", "roll")
    assert (arm.gripper.joint, arm.tcp_link) == ("l", "pinch")
    assert arm.joint_by_name["r"].mimic.multiplier == multiplier
    assert arm.gripper.max_effort == pytest.approx(effort)
    assert arm.gripper.widths[:, 1].max() == pytest.approx(0.09, abs=1e-6)
    assert not [note for note in arm.notes if "tendons are ignored" in note]


def test_a_missing_texture_is_not_needed(tmp_path):
    texture = '<texture name="wood" type="2d" file="gone.png"/><material name="m" texture="wood"/>'
    text = MJCF.replace("</asset>", texture + "</asset>")
    text = text.replace('size="0.05 0.05"', 'material="m" size="0.05 0.05"')
    assert (text.count("wood"), text.count('"m"')) == (2, 2)
    write(tmp_path, text)
    assert set(load(tmp_path).joint_names) == set(JOINTS)


def test_a_missing_mesh_that_touches_nothing_is_a_note(tmp_path):
    look = '<geom type="mesh" mesh="look" contype="0" conaffinity="0"/>'
    assets = '<mesh name="look" file="gone.obj"/><skin name="soft" file="gone.skn"/>'
    text = MJCF.replace("</asset>", assets + "</asset>").replace('<site name="tcp"', look + "<site")
    write(tmp_path, text.replace("<site pos", '<site name="tcp" pos'))
    arm = load(tmp_path)
    [note] = [note for note in arm.notes if "gone" in note]
    assert note.startswith("meshes that are not drawn: look; the first: mesh 'gone.obj' is not th")
    assert len({link.name: link for link in arm.links}["wrist"].visuals) == 1


def test_the_last_compiler_says_where_meshes_are_whatever_it_includes(tmp_path):
    """As MuJoCo has it: the include comes first in the file, and its `meshdir` does not count."""
    (tmp_path / "more.xml").write_text('<mujoco><compiler meshdir="elsewhere"/></mujoco>')
    write(tmp_path, MJCF.replace("<compiler", '<include file="more.xml"/><compiler', 1))
    assert set(load(tmp_path).joint_names) == set(JOINTS)


def test_what_no_actuator_moves_is_not_part_of_the_robot(tmp_path):
    """A scene's drawer, and a slider without a range; a file without actuators keeps them."""
    drawer = (
        '<body name="chest" pos="1 1 0"><geom size="0.1"/><body name="drawer"><geom size="0.1"/>'
        '<joint name="pull" type="slide" range="0 0.3"/></body></body><body name="puck">'
        '<joint name="push" type="slide"/><geom size="0.02"/></body>'
    )
    text = MJCF.replace("</worldbody>", drawer + "</worldbody>")
    write(tmp_path, text)
    arm = load(tmp_path)
    assert set(arm.joint_names) == set(JOINTS)
    assert any(note.endswith("left out: cube, chest, drawer, puck") for note in arm.notes)
    passive = re.sub("(?s)<actuator>.*</actuator>", "", text).replace(
        '"slide"/>', '"slide" range="0 1"/>'
    )
    write(tmp_path, passive)
    assert {"pull", "push"} < set(load(tmp_path).joint_names)


def test_a_file_without_joints_is_refused(tmp_path):
    write(
        tmp_path, '<mujoco><worldbody><body name="a"><geom size="1"/></body></worldbody></mujoco>'
    )
    with pytest.raises(RobotError, match="no group has a joint that moves"):
        load_robot(RobotSpec(mjcf="arm.xml"), tmp_path)


def test_joints_of_a_closed_linkage_follow_its_driven_joint(tmp_path):
    """As in Robotiq's 2F-85 of the MuJoCo Menagerie: a tree cannot hold the loop."""
    write(tmp_path, LINKAGE)
    arm = load_robot(RobotSpec(mjcf="arm.xml"), tmp_path)
    mimics = {joint.name: joint.mimic for joint in arm.movable_joints if joint.mimic}
    assert {name: mimic.joint for name, mimic in mimics.items()} == dict.fromkeys(
        ("right_crank", "left_rocker", "left_pad", "right_rocker", "right_pad"), "left_crank"
    )
    assert mimics["right_rocker"].multiplier == pytest.approx(1, abs=0.02)
    assert mimics["right_pad"].multiplier == pytest.approx(-1, abs=0.02)
    assert arm.gripper.joint == "left_crank"
    assert sorted(arm.gripper.pads.values()) == ["left_pad", "right_pad"]
    assert not any("connect" in note for note in arm.notes)
