"""`harness robot check|show`: what it says of good robots, and of bad ones."""

import json
import re
from dataclasses import replace

import cv2
import numpy as np
import pytest

from harness.cli.main import main
from harness.core.resources import data_folder
from harness.core.spatial import SE3
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.authoring import robot_check, robot_findings
from harness.plugins.authoring.pair_statistics import self_touches
from harness.robot.mechanism import Inertial
from harness.robot.random_positions import sample_robot_positions
from harness.robot.srdf.srdf import parse_srdf
from tests.robot.arm_files import INERTIAL, LIMIT, SHAPE, SRDF, URDF, load_arm, write_arm
from tests.robot.models import Arm, robot


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_arm(tmp_path)
    return tmp_path


def check(capsys, *arguments):
    """Exit code and page of `robot check`, with few samples by default."""
    code = main(["robot", "check", "--samples", "100", *arguments])
    out, err = capsys.readouterr()
    return code, out + err


def test_a_bundled_robot_is_reported_on_one_page(capsys):
    code, page = check(capsys, "ur3e", "--gripper", "rh_p12_rn_a", "--samples", "300")
    assert code == 0
    assert len(page.splitlines()) < 50
    for line in (
        "wrist_3_joint        revolute  -6.133  6.133     6.283             5",
        "follows rh_r1_joint times 1",
        "ur_manipulator (the arm): 6 joints, base_link to end_effector_link",
        "      states: home, up, test_configuration, mogi_home, mogi_down",
        "rh_p12_rn_l1 and rh_p12_rn_l2, 107 mm apart, at most 9.69 N m",
        "✓ masses: 11.21 kg, 9.214 kg of it moving",
        "✓ named states: 7 and the start are free",
        "✓ inverse kinematics: ur solves 100 of 100 poses that can be taken",
    ):
        assert line in page
    assert "✗" not in page


@pytest.mark.parametrize("name", ["open_manipulator_x", "rh_p12_rn_a"])
def test_other_bundled_robots_are_good_too(name, capsys):
    assert check(capsys, name)[0] == 0


@pytest.mark.nightly
def test_the_same_seed_says_the_same_and_another_differs(capsys):
    first, again, other = (check(capsys, "ur3e", "--seed", seed) for seed in ("3", "3", "4"))
    assert first == again
    assert first != other


def test_rates_are_those_that_another_checker_finds():
    ours = robot(model="ur5e")
    theirs = Arm(ours)
    positions = sample_robot_positions(ours, 200, np.random.default_rng(5))
    touching = [
        theirs.touching(dict(zip(ours.joint_names, row, strict=True))) is not None
        for row in positions
    ]
    assert self_touches(ours, positions).is_free.tolist() == [not each for each in touching]
    assert 10 < sum(touching) < 100


def test_one_json_document_has_the_numbers(capsys):
    assert main(["robot", "check", "arm.urdf", "--srdf", "arm.srdf", "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    assert (reported["format"], reported["exit_code"]) == ("armharness-robot/1", 0)
    values = {each["about"]: each["values"] for each in reported["robot"]["findings"]}
    assert values["masses"] == {"mass": 4.0, "moving_mass": 3.0, "problems": 0}
    assert values["forward kinematics"]["position_error"] < 1e-9
    assert values["forward kinematics"]["mass_in_physics"] == pytest.approx(4.0, abs=1e-9)
    assert values["inverse kinematics"]["solver"] == "numeric"
    # upright and drawn out: 0.2 m to the wrist, 0.2 m of travel, 0.2 m to the tool, 0.3 m below
    assert 0.85 < values["reach"]["reach"] <= 0.9


AT = '<origin xyz="0 0 0.2"/>'
LYING = INERTIAL.replace('izz="0.002"', 'izz="0.05"')
UNIT = INERTIAL.replace('ixx="0.01" iyy="0.01" izz="0.002"', 'ixx="1" iyy="1" izz="1"')


@pytest.mark.parametrize("link", ["lower", "wrist"])
@pytest.mark.parametrize(
    ("stated", "moments"),
    [
        ('izz="0.05"', "0.01, 0.01, 0.05"),
        ('izz="-1e-06"', "-1e-06, 0.01, 0.01"),
        ('izz="-0.004"', "-0.004, 0.01, 0.01"),
        ('izz="0.002" ixz="0.006"', "-0.00121, 0.01, 0.0132"),
    ],
)
def test_a_corrected_inertia_is_reported_once(link, stated, moments, folder, capsys):
    other = INERTIAL.replace('izz="0.002"', stated)
    assert f'"{link}">{INERTIAL}' in URDF
    write_arm(folder, URDF.replace(f'"{link}">{INERTIAL}', f'"{link}">{other}'), SRDF)
    _, page = check(capsys, "arm.urdf", "--srdf", "arm.srdf", "--samples", "5")
    said = f"link '{link}': no body has the principal moments of inertia {moments} kg m^2"
    assert page.count(said) == 1


def test_an_inertia_with_a_sign_that_no_rounding_gives_is_refused(folder, capsys):
    other = INERTIAL.replace('izz="0.002"', 'izz="-0.02"')
    write_arm(folder, URDF.replace(f'"lower">{INERTIAL}', f'"lower">{other}'), SRDF)
    assert main(["robot", "check", "arm.urdf", "--srdf", "arm.srdf"]) == 2
    said = capsys.readouterr().err
    assert "negative moment of inertia, -0.02 kg m^2" in said
    assert "without" in said.split()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (f'"lower">{INERTIAL}', f'"lower">{LYING}',
         "✗ masses: 4 kg, 3 kg of it moving\n      link 'lower': no body has the principal moments"
         " of inertia 0.01, 0.01, 0.05 kg m^2"),
        (f"{AT}<axis xyz=\"0 0 1\"/>", f"{AT.replace('0.2', '-0.3')}<axis xyz=\"0 0 1\"/>",
         "✗ named states: 2 of 2 cannot be taken\n      the start: upper touches wrist"),
        ('<cylinder radius="0.03" length="0.14"/>', '<cylinder radius="30" length="140"/>',
         "✗ sizes: 3 of 3 links are larger than 10 m\n      upper: a shape is 140 m long;"
         " files in millimetres need `scale` 0.001"),
    ],
    ids=["triangle", "states", "sizes"],
)  # fmt: skip
def test_what_is_wrong_is_exit_code_1_and_reported(old, new, said, folder, monkeypatch, capsys):
    assert old in URDF
    write_arm(folder, URDF.replace(old, new), SRDF.replace('link2="wrist"', 'link2="tool"'))
    monkeypatch.setattr(robot_check, "IK_SAMPLES", 5)
    code, page = check(capsys, "arm.urdf", "--srdf", "arm.srdf")
    assert code == 1
    assert said in page


@pytest.mark.parametrize(
    ("urdf", "said"),
    [
        (URDF.replace(f'"wrist">{INERTIAL}', f'"wrist">{UNIT}'),
         "link 'wrist': the inertia is the unit tensor, a placeholder"),
        (URDF.replace('effort="80"', 'effort="1000"'), "reach: an effort of 1000 is a placeholder"),
        (URDF.replace('lower="-2" upper="2"', 'lower="-110" upper="110"'),
         "bend: -110 to 110 rad are 35 turns; degrees are -1.92 to 1.92 rad"),
        (URDF, "3 links have the same 1 kg and the same inertia, a placeholder: upper, lower"),
        (URDF.replace("</robot>", "<transmission name='t'/></robot>"), "left out or assumed\n"),
        (URDF.replace('"tool"/>', f'"tool">{SHAPE}</link>', 1), "no <inertial>: tool"),
    ],
)  # fmt: skip
def test_what_looks_doubtful_is_reported_and_is_no_failure(urdf, said, folder, monkeypatch, capsys):
    write_arm(folder, urdf)
    monkeypatch.setattr(robot_check, "IK_SAMPLES", 5)
    code, page = check(capsys, "arm.urdf", "--srdf", "arm.srdf")
    assert code == 0
    assert said in page


def test_a_scenario_is_checked_with_the_masses_of_its_robot(folder, capsys):
    write_arm(folder, URDF.replace(f'"wrist">{INERTIAL}', f'"wrist">{UNIT}'))
    text = "scenario: s\nrobot: {urdf: arm.urdf}\nsteps: [wait: 1 s]\n"
    (folder / "s.scenario.yaml").write_text(text)
    assert main(["check", "s.scenario.yaml"]) == 0
    said = capsys.readouterr().out
    assert "note: robot: link 'wrist': the inertia is the unit tensor, a placeholder" in said


def test_a_model_that_differs_in_physics_would_be_found(folder):
    ours = load_arm(folder)
    shifted = tuple(
        replace(joint, pose=joint.pose @ SE3(np.eye(3), np.array([0.0, 0.0, 1e-6])))
        if joint.name == "bend"
        else joint
        for joint in ours.joints
    )
    heavier = tuple(
        replace(link, inertial=Inertial(2.0, np.zeros(3), 0.01 * np.eye(3)))
        if link.name == "tool"
        else link
        for link in ours.links
    )
    rows = sample_robot_positions(ours, 5, np.random.default_rng(1))
    kinematics = PinocchioKinematics(ours)
    assert robot_findings.forward_kinematics(ours, kinematics, rows).is_good
    moved = robot_findings.forward_kinematics(replace(ours, joints=shifted), kinematics, rows)
    assert not moved.is_good
    assert moved.details[0] in ("most at lower", "most at wrist", "most at tool")
    assert moved.values["position_error"] == pytest.approx(1e-6)
    # the physics of one robot against what another says it weighs
    theirs = robot_findings.masses(replace(ours, links=heavier)).values["mass"]
    assert theirs == pytest.approx(6.0)


@pytest.mark.nightly
def test_an_arm_of_one_joint_is_looked_over(folder, capsys):
    one = f"""<robot name="one"><link name="a"/><link name="b">{INERTIAL}{SHAPE}</link>
    <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>{LIMIT}
    </joint></robot>"""
    (folder / "one.xml").write_text(one)  # a URDF by its content
    code, page = check(capsys, "one.xml")
    assert code == 0
    assert "numeric solves 100 of 100 poses" in page


MJCF = """<mujoco model="two"><worldbody><body name="base"><geom size="0.05" mass="1"/>
<body name="upper" pos="0 0 0.1"><joint name="a" axis="0 1 0" range="-100 100"/>
<geom type="capsule" fromto="0 0 0.05 0 0 0.3" size="0.03" mass="1"/>
<body name="lower" pos="0 0 0.35"><joint name="b" axis="0 1 0" range="-100 100"/>
<geom type="capsule" fromto="0 0 0.05 0 0 0.3" size="0.03" mass="1"/>
<site name="tool" pos="0 0 0.33"/></body></body></body></worldbody>
<keyframe><key name="bent" qpos="0.5 1"/></keyframe></mujoco>"""


def test_an_mjcf_is_looked_over_too(folder, capsys):
    (folder / "two.xml").write_text(MJCF)
    code, page = check(capsys, "two.xml", "--tcp-link", "tool", "--state", "bent")
    assert code == 0
    assert "  arm (the arm): 2 joints, robot_world to tool\n      states: bent" in page
    assert "✓ masses: 3 kg, 2 kg of it moving" in page


def test_a_xacro_file_is_rendered_with_its_arguments(capsys):
    xacro = str(data_folder("robots") / "universal_robots/ur.urdf.xacro")
    words = ("--srdf", xacro.replace("ur.urdf.xacro", "ur.srdf"), "--args")
    for name in ("ur10e", "ur3e"):
        code, page = check(capsys, xacro, *words, f"ur_type={name}")
        assert code == 0
        total = sum(link.inertial.mass for link in robot(model=name).links if link.inertial)
        assert f"✓ masses: {total:.4g} kg" in page
        assert re.search(r"✓ inverse kinematics: ur solves (\d+) of \1 poses", page)
    code, said = check(capsys, xacro, "--args", "ur_typ=ur3e")
    assert code == 2
    assert "takes no argument 'ur_typ'; known are meshes" in said


def test_without_srdf_pairs_are_proposed_and_written(folder, capsys):
    code, page = check(capsys, "arm.urdf", "--write-srdf", "out/arm.srdf", "--samples", "500")
    assert code == 0
    assert "  adjacent: 2: lower - upper, lower - wrist" in page
    assert "  never: 1: upper - wrist" in page
    assert page.endswith("wrote out/arm.srdf\n")
    written = (folder / "out/arm.srdf").read_bytes()
    assert parse_srdf(written, "arm.srdf").disabled == {
        ("lower", "upper"): "Adjacent",
        ("lower", "wrist"): "Adjacent",
        ("upper", "wrist"): "Never",
    }
    with_it = check(capsys, "arm.urdf", "--srdf", "out/arm.srdf")[1]
    assert "3 pairs are allowed" in with_it
    assert "proposed" not in with_it
    assert "no SRDF" not in with_it


def test_links_that_touch_always_or_at_the_start_are_distinguished(folder, capsys):
    box = '<collision><origin xyz="{}"/><geometry><box size="{}"/></geometry></collision>'
    base = f'"base_link">{INERTIAL}'
    above = base + box.format("0 0 0.42", "0.05 0.05 0.05")
    write_arm(folder, URDF.replace(base, above))
    page = check(capsys, "arm.urdf", "--samples", "400")[1]
    assert "  default: 1: base_link - lower" in page
    assert "  never: 2: base_link - wrist, upper - wrist" in page
    walls = [box.format(f"{side}0.54 0 0.3", "1 2 2") for side in ("", "-")]
    walls += [box.format(f"0 {side}0.54 0.3", "2 1 2") for side in ("", "-")]
    write_arm(folder, URDF.replace(base, base + "".join(walls)))
    page = check(capsys, "arm.urdf", "--samples", "400")[1]
    assert "  always: 2: base_link - lower, base_link - wrist" in page
    assert "default" not in page


@pytest.mark.nightly
def test_pairs_of_a_universal_robot_are_those_that_moveit_has(folder):
    """Adjacent ones all; of the rest, ur_description's own come out as never touching."""
    assert main(["robot", "check", "ur5e", "--write-srdf", "ur.srdf", "--samples", "3000"]) == 0
    ours = parse_srdf((folder / "ur.srdf").read_bytes(), "ur.srdf").disabled
    theirs = robot(model="ur5e").allowed_collisions
    frames = {"base_link", "tool0"}  # without shapes: nothing to propose
    known = {pair: why for pair, why in theirs.items() if not set(pair) & frames}
    assert {pair: why for pair, why in ours.items() if pair in known} == known
    assert set(ours.values()) == {"Adjacent", "Never"}


@pytest.mark.nightly
def test_a_picture_is_drawn_on_request(folder, capsys):
    """The two states of an arm with looks differ by more than lines of the floor."""
    assert main(["robot", "show", "ur3e", "--state", "mogi_home"]) == 0
    assert capsys.readouterr().out == "wrote ur3e.png\n"
    assert check(capsys, "ur3e", "--image", "pictures/start.jpg")[0] == 0
    bent, start = (cv2.imread(str(folder / name)) for name in ("ur3e.png", "pictures/start.jpg"))
    assert bent.shape == start.shape == (800, 800, 3)
    assert np.abs(bent.astype(int) - start).max() > 60


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["check", "ur3f"], "robot.model: 'ur3f' is not known; did you mean `ur3`? robots:"),
        (["check", "harm.urdf"], "there is no file harm.urdf; did you mean 'arm.urdf'?"),
        (["check", "arm.urdf", "--srdf", "a.srdf"], "robot.srdf: there is no file a.srdf"),
        (["check", "ur3e", "--srdf", "arm.srdf"], "robot.srdf: it requires a robot's file"),
        (["check", "arm.urdf", "--write-srdf", "arm.srdf"], "'arm.srdf' exists already; nothing"),
        (["check", "arm.urdf", "--image", "arm.gif"], "in .png or .jpg or .jpeg, not 'arm.gif'"),
        (["show", "arm.urdf", "--state", "hom"], "there is no state 'hom'; there are no states"),
        (["show", "arm.urdf", "--srdf", "arm.srdf", "--state", "hom"], "did you mean `home`?"),
        (["check", "cell.yaml", "--gripper", "hand"], "its robot itself: --gripper is for others"),
        (["check", "arm.urdf", "--package-path", "no"], "robot.packages: there is no folder no"),
    ],
)  # fmt: skip
def test_wrong_words_are_exit_code_2_and_write_nothing(arguments, said, folder, capsys):
    before = sorted(folder.iterdir())
    assert main(["robot", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert said in err
    assert sorted(folder.iterdir()) == before


def test_a_folder_that_is_no_robot_is_reported_what_it_lacks(folder, capsys):
    (folder / "cell").mkdir()
    assert main(["robot", "check", "cell"]) == 2
    assert "'cell' is not known; cell has no robot.yaml; robots:" in capsys.readouterr().err


def test_a_robot_that_is_never_free_is_reported(capsys):
    code, page = check(capsys, "ur3", "--samples", "1")
    assert code == 1
    assert "✗ reach: no configuration is free of self-collision" in page
    assert "inverse kinematics" not in page


@pytest.mark.nightly
def test_a_xacro_file_is_known_by_its_content_too(folder, capsys):
    root = '<robot name="three" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    text = URDF.replace('<robot name="three">', f'{root}<xacro:arg name="high" default="2"/>')
    (folder / "drawn.urdf").write_text(text.replace('upper="2"', 'upper="$(arg high)"'))
    code, page = check(capsys, "drawn.urdf", "--srdf", "arm.srdf", "--args", "high=1.5")
    assert code == 0
    assert re.search(r"bend +revolute +-2 +1.5", page)


def test_a_scenario_and_a_folder_name_a_robot_too(folder, capsys):
    (folder / "a.scenario.yaml").write_text(
        "scenario: a\nrobot: {urdf: arm.urdf, srdf: arm.srdf}\nsteps: [{wait: 1 s}]\n"
    )
    (folder / "robot.yaml").write_text(
        "robot: three\nkind: arm\nurdf: arm.urdf\nsrdf: arm.srdf\narm_group: manipulator\n"
        "tcp_link: tool\n"
    )
    for word in ("a.scenario.yaml", "robot.yaml", str(folder)):
        code, page = check(capsys, word)
        assert code == 0
        assert "manipulator (the arm): 3 joints, base_link to tool" in page


def test_a_gripper_alone_is_checked_without_pose_goals(capsys, folder):
    """Its longest chain ends at a finger that mimics the driven joint."""
    joint = (
        '<joint name="{0}_joint" type="revolute"><parent link="{1}"/><child link="{0}"/>'
        f'<origin xyz="0 0 0.05"/><axis xyz="1 0 0"/>{LIMIT}{{2}}</joint>'
        f'<link name="{{0}}">{INERTIAL}</link>'
    )
    first = joint.format("knuckle", "palm", "")
    second = joint.format("tip", "knuckle", '<mimic joint="knuckle_joint"/>')
    text = f'<robot name="hand"><link name="palm">{INERTIAL}</link>{first}{second}</robot>'
    (folder / "hand.urdf").write_text(text)
    code, page = check(capsys, "hand.urdf")
    assert code == 0, page
    assert "inverse kinematics: not tried, there are no pose goals: link 'tip'" in page


XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
BODY = """<body name="{0}" pos="0 0 0.2"><joint name="{0}_joint" axis="0 {1} 1" range="-1 1"/>
  <geom type="box" size="0.02 0.02 0.05" pos="0 0 0.1"/>{2}</body>"""
OWN_MJCF = f"""<mujoco model="two_links"><compiler angle="radian"/><worldbody>
  {BODY.format("a", 0, BODY.format("b", 1, ""))}</worldbody></mujoco>"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("file", "text", "name"),
    [
        ("arm.urdf", URDF, "three"),
        (
            "arm.xacro",
            URDF.replace("<robot ", '<robot xmlns:xacro="http://ros.org/xacro" '),
            "three",
        ),
        ("own.xml", OWN_MJCF, "two_links"),
    ],
)
def test_a_written_srdf_has_the_name_of_the_robot_in_its_file(capsys, folder, file, text, name):
    (folder / file).write_text(text, encoding="utf-8")
    code, page = check(capsys, file, "--write-srdf", "new.srdf")
    assert code == 0, page
    assert f'<robot name="{name}">' in (folder / "new.srdf").read_text(encoding="utf-8")
