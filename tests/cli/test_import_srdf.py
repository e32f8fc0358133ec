"""`harness import srdf`: the folder it writes is the robot that the files are."""

import shutil

import numpy as np
import pytest
import yaml

from harness.cli.main import main
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.robot.load import load_robot
from harness.robot.random_positions import sample_robot_positions
from tests.robot.arm_files import load_arm
from tests.robot.hands import HAND, LEFT, PALM, RIGHT, write
from tests.robot.test_mesh_file import STL

EYE = """link: palm
pose: {xyz: [0, 0, 0.1]}
horizontal_fov: 1.2
image: {width: 320, height: 200, format: L8}
clip: {near: 0.05, far: 3.0}
noise: {type: gaussian, stddev: 0.01}
update_rate: 10
optical_frame_id: eye_optical
"""
MESH = '<visual><geometry><mesh filename="looks/part.stl" scale="0.1 0.1 0.1"/></geometry></visual>'


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write(tmp_path, HAND.replace('<link name="palm">', f'<link name="palm">{MESH}'))
    (tmp_path / "looks").mkdir()
    (tmp_path / "looks/part.stl").write_text(STL)
    return tmp_path


def imported(folder):
    return load_robot(RobotSpec(model="three"), folder)


def test_the_folder_is_the_same_robot(folder, capsys):
    assert main(["import", "srdf", "arm.srdf", "--robot", "arm.urdf", "-o", "three"]) == 0
    said = capsys.readouterr().out
    assert "note: no acceleration limits: 5 rad/s^2" in said
    assert said.endswith(
        "wrote three/robot.yaml, three/three.urdf, three/three.srdf; `robot: {model: three}`\n"
    )
    theirs, ours = load_arm(folder), imported(folder)
    assert ours.joint_names == theirs.joint_names
    for name in ("lower", "upper", "velocity", "effort", "damping", "mimic", "kind"):
        mine, own = ([getattr(j, name) for j in each.joints] for each in (ours, theirs))
        assert mine == own, name
    accelerations = [[j.acceleration for j in each.movable_joints] for each in (ours, theirs)]
    assert accelerations[0] == pytest.approx(accelerations[1])
    assert (ours.arm_group, ours.tcp_link) == (theirs.arm_group, theirs.tcp_link)
    assert ours.groups == theirs.groups
    assert ours.named_states == theirs.named_states
    assert ours.allowed_collisions.keys() == theirs.allowed_collisions.keys()
    assert ours.start_positions() == pytest.approx(theirs.start_positions())
    assert ours.gripper.widths == pytest.approx(theirs.gripper.widths)
    assert ours.gripper.grip_effort == pytest.approx(theirs.gripper.grip_effort)
    assert ours.gripper.sides == theirs.gripper.sides
    rows = sample_robot_positions(theirs, 5, np.random.default_rng(2))
    links = theirs.link_names
    poses = [PinocchioKinematics(each).link_poses(rows, links) for each in (ours, theirs)]
    assert poses[0] == pytest.approx(poses[1], abs=1e-12)
    looks = [
        next(link for link in each.links if link.name == "palm").visuals[0].geometry
        for each in (ours, theirs)
    ]
    assert looks[0] == looks[1]


def test_a_picking_scenario_can_name_the_folder(folder, capsys):
    assert main(["import", "srdf", "arm.srdf", "--robot", "arm.urdf", "-o", "three"]) == 0
    (folder / "a.scenario.yaml").write_text(
        "scenario: a\nrobot: {model: three, base: {xyz: [0, 0, 1]}}\n"
        "steps: [{gripper: {width: 3 cm}}, {move_to: home}]\n"
    )
    assert main(["run", "--no-report", "--in-process", "a.scenario.yaml"]) == 0
    assert "passed" in capsys.readouterr().out


def test_fingers_that_no_mimic_couples_are_coupled_in_what_is_written(folder):
    right = RIGHT.replace('<mimic joint="left_joint"/>', "")
    write(folder, PALM + LEFT + right, '<group name="hand"><joint name="left_joint"/>'
          '<joint name="right_joint"/></group><end_effector name="grip" parent_link="tool"'
          ' group="hand" parent_group="manipulator"/>')  # fmt: skip
    assert main(["import", "srdf", "arm.srdf", "--robot", "arm.urdf", "-o", "three"]) == 0
    assert imported(folder).joint_by_name["right_joint"].mimic.joint == "left_joint"


def test_what_the_folder_says_can_be_changed(folder):
    assert main(["import", "srdf", "arm.srdf", "--robot", "arm.urdf", "-o", "three"]) == 0
    path = folder / "three/robot.yaml"
    facts = yaml.safe_load(path.read_text())
    facts["gripper"]["grip_effort"] = 11.0
    facts["joints"]["bend"]["max_effort"] = 12.5
    facts["cameras"] = {"eye": yaml.safe_load(EYE)}
    path.write_text(yaml.safe_dump(facts))
    ours = imported(folder)
    assert ours.gripper.grip_effort == 11.0
    assert ours.joint_by_name["bend"].effort == 12.5
    eye = ours.cameras["eye"]
    assert (eye.frame, eye.optical_frame_id, eye.update_rate) == ("palm", "eye_optical", 10)
    assert (eye.width, eye.height, eye.is_grey, eye.horizontal_fov) == (320, 200, True, 1.2)
    assert (eye.clip_near, eye.clip_far, eye.noise_stddev) == (0.05, 3.0, 0.01)
    assert eye.pose.translation == pytest.approx([0, 0, 0.1])


def test_meshes_are_found_from_wherever_the_folder_is(folder):
    assert main(["import", "srdf", "arm.srdf", "--robot", "arm.urdf", "-o", "far/off/three"]) == 0
    far = load_robot(RobotSpec(model="far/off/three"), folder)
    palm = next(link for link in far.links if link.name == "palm")
    assert palm.visuals[0].geometry.path == (folder / "looks/part.stl").resolve()
    shutil.rmtree(folder / "looks")
    assert main(["robot", "check", "far/off/three"]) == 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["."], "'.' is a folder: name the SRDF in it"),
        (["arm.srdf"], "an SRDF says nothing without its robot: --robot FILE"),
        (["arm.srdf", "--robot", "ur3e"], "--robot is a URDF, xacro, MJCF or SDF file, not 'ur3e'"),
        (["arm.srdf", "--robot", "arm.urdf", "-o", "a.yaml"], "'a.yaml' is no folder"),
        (["no.srdf", "--robot", "arm.urdf"], "robot.srdf: there is no file no.srdf"),
        (["arm.srdf", "--robot", "harm.urdf"], "there is no file harm.urdf; did you mean"),
        (["arm.srdf", "--robot", "arm.urdf", "--gripper", "paw"], "the SRDF has no group 'paw'"),
        (["arm.srdf", "--robot", "arm.urdf", "--model-path", "."], "--model-path is for SDF"),
        (["arm.urdf", "--robot", "arm.urdf"], "arm.urdf:3:4: this is a URDF"),
    ],
)
def test_wrong_words_are_exit_code_2_and_write_nothing(arguments, said, folder, capsys):
    before = sorted(folder.rglob("*"))
    assert main(["import", "srdf", *arguments]) == 2
    assert said in capsys.readouterr().err
    assert sorted(folder.rglob("*")) == before


def test_nothing_is_overwritten_unless_requested(folder, capsys):
    words = ["import", "srdf", "arm.srdf", "--robot", "arm.urdf", "-o", "three"]
    assert main(words) == 0
    (folder / "three/robot.yaml").write_text("mine")
    assert main(words) == 2
    assert "exists already" in capsys.readouterr().err
    assert (folder / "three/robot.yaml").read_text() == "mine"
    assert main([*words, "--force"]) == 0
    assert imported(folder).gripper is not None
