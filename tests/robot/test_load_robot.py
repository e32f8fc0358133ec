"""Options of a scenario's robot, and what it says when they do not fit."""

import re
import shutil
import subprocess
import sys

import pytest

from harness.core.errors import RobotError, SpecError
from harness.core.resources import data_folder
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.robot.models import robot


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ({"model": "ur3x"}, ["'ur3x' is not known", "did you mean `ur3", "ur30"]),
        ({"model": "open_manipulator"}, ["did you mean `open_manipulator_x`"]),
        ({"model": "ur3e", "gripper": "rh_p12"}, ["robot.gripper", "did you mean `rh_p12_rn_a`"]),
        ({"model": "ur3e", "gripper": "ur5e"}, ["'ur5e' is an arm", "rh_p12_rn_a"]),
        ({"model": "rh_p12_rn_a", "gripper": "rh_p12_rn_a"}, ["is a gripper"]),
        ({"model": "./nowhere"}, ["nowhere has no robot.yaml"]),
        ({"urdf": "arm.urdf"}, ["robot.urdf: there is no file arm.urdf"]),
        ({"model": "ur3e", "srdf": "a.srdf"}, ["robot.srdf: it requires a robot's file"]),
        ({"model": "ur3e", "tcp_link": "tool0"}, ["robot.tcp_link: it requires a robot's file"]),
        ({"xacro": "arm.xacro"}, ["robot.xacro: there is no file"]),
        ({"mjcf": "arm.xml"}, ["robot.mjcf: there is no file"]),
        ({"model": "ur3e", "base": {"frame": "Table"}}, ["'world'", "'Table'"]),
        ({"model": "ur3e", "args": {"tool": "x"}}, ["no argument 'tool'", "safety_limits"]),
        ({"model": "ur3e", "args": {"ur_type": "ur5"}}, ["no argument 'ur_type'"]),
        ({"model": "open_manipulator_x", "args": {"a": 1}}, ["takes no arguments"]),
        (
            {"model": "ur3e", "joint_limits": {"elbow": {"max_velocity": 1}}},
            ["no joint 'elbow'", "did you mean `elbow_joint`"],
        ),
        (
            {"model": "ur3e", "joint_limits": {"elbow_joint": {"max_position": 3.2}}},
            ["max_position: 3.2 is more than the robot's 2.99159", "narrowed only"],
        ),
        (
            {"model": "ur3e", "joint_limits": {"elbow_joint": {"max_effort": 100}}},
            ["max_effort: 100 is more than the robot's 28"],
        ),
        (
            {"model": "ur3e", "named_states": {"arm": {"ready": {"elbow_joint": 1}}}},
            ["no group 'arm'", "ur_manipulator"],
        ),
        (
            {"model": "ur3e", "named_states": {"ur_manipulator": {"far": {"elbow_joint": 4}}}},
            ["ur_manipulator.far", "'elbow_joint' at 4 is outside its limits"],
        ),
        ({"model": "ur3e", "start_state": "there"}, ["no state 'there'", "mogi_home"]),
        (
            {"model": "ur3e", "start_state": {"joints": {"joint1": 0}}},
            ["no joint 'joint1'", "shoulder_pan_joint"],
        ),
    ],
)
def test_what_does_not_fit_is_said_with_the_way_out(spec, words):
    with pytest.raises(RobotError) as caught:
        robot(**spec)
    for word in words:
        assert word in str(caught.value)


def test_an_argument_that_is_no_number_is_reported_where_it_is_used():
    with pytest.raises(SpecError, match="name 'wide' is not defined") as caught:
        robot(model="ur3e", args={"safety_pos_margin": "wide"})
    assert "$(arg safety_pos_margin)" in caught.value.problems[0].source_line


def test_limits_can_be_narrowed():
    limits = {"max_position": 1.0, "min_position": -0.5, "max_velocity": 0.7, "max_effort": 5}
    description = robot(model="ur3e", joint_limits={"elbow_joint": limits})
    joint = description.joint_by_name["elbow_joint"]
    assert (joint.lower, joint.upper, joint.velocity, joint.effort) == (-0.5, 1.0, 0.7, 5)
    assert robot(model="ur3e").joint_by_name["elbow_joint"].upper > 2.9, (
        "the bundled one is as before"
    )


def test_a_scenario_adds_states_and_says_where_the_robot_starts():
    states = {"ur_manipulator": {"ready": {"elbow_joint": 1.0}, "up": {"elbow_joint": 0.5}}}
    description = robot(model="ur3e", named_states=states, start_state="ready")
    assert description.states_of("ur_manipulator")["ready"].positions == {"elbow_joint": 1.0}
    assert description.states_of("ur_manipulator")["up"].positions == {"elbow_joint": 0.5}
    assert description.start_state["elbow_joint"] == 1.0
    assert description.start_state["shoulder_lift_joint"] == -1.57, "others as the robot starts"
    assert 'name="ready"' in description.srdf


def test_a_folder_next_to_the_scenario_is_a_robot(tmp_path):
    shutil.copytree(data_folder("robots") / "open_manipulator_x", tmp_path / "mine")
    spec = RobotSpec.model_validate({"model": "mine"})
    mine = load_robot(spec, tmp_path)
    assert mine.urdf == robot(model="open_manipulator_x").urdf


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("kind: arm", "kind: leg", ["robot.yaml:3:7: kind"]),
        ("tcp_link: end_effector_link", "tcp_lnk: x", ["robot.yaml:8:", "tcp_lnk: "]),
        ("grip_effort: 10.0", "grip_effort: -1", ["robot.yaml:", "gripper.grip_effort"]),
        ("gripper_right_joint: *finger", "thumb: *finger", ["joints.thumb", "no joint 'thumb'"]),
        ("robot: open_manipulator_x", "robot: [", ["robot.yaml:2:8: not YAML"]),
        ("srdf: open_manipulator_x.srdf", "srdf: gone.srdf", ["gone.srdf", "no such file"]),
        ("arm_group: arm", "arm_group: arms", ["robot.yaml:7:12", "did you mean `arm`?"]),
        ("tcp_link: end_effector_link", "tcp_link: tool", ["tcp_link: the URDF has no link"]),
        ("palm_link: link5", "palm_link: link55", ["gripper.palm_link: the URDF has no link"]),
        ("group: gripper", "group: hand", ["gripper.group: the SRDF has no group 'hand'"]),
        ("pad: gripper_left_link", "pad: link5", ["gripper.sides.left.pad: the side has no link"]),
        (
            "kind: arm",
            "kind: arm\ncollision: {lnk2: hull}",
            ["collision.lnk2: the URDF has no link"],
        ),
        ("friction: 1.0", "friction: 1e308", ["gripper.friction: ", "1e+308"]),
    ],
)
def test_a_mistake_in_robot_yaml_is_named_by_file_and_key(tmp_path, old, new, words):
    shutil.copytree(data_folder("robots") / "open_manipulator_x", tmp_path / "mine")
    path = tmp_path / "mine" / "robot.yaml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        load_robot(RobotSpec.model_validate({"model": "mine"}), tmp_path)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize("name", ["robot.yaml", "{}.srdf", "{}.urdf"])
@pytest.mark.parametrize("model", ["open_manipulator_x", "rh_p12_rn_a"])
def test_a_file_of_a_folder_that_is_not_utf8_is_named_with_its_place(tmp_path, model, name):
    folder = shutil.copytree(data_folder("robots") / model, tmp_path / "mine")
    path = folder / name.format(model)
    path.write_bytes(path.read_bytes().replace(b"robot", b"rob\xfft", 1))
    with pytest.raises(SpecError, match=rf"{path.name}:\d+:\d+: not UTF-8 text"):
        load_robot(RobotSpec.model_validate({"model": "mine"}), tmp_path)


@pytest.mark.parametrize(
    ("model", "state", "joint"),
    [
        ("open_manipulator_x", "open", "gripper_left_joint"),
        ("open_manipulator_x", "close", "gripper_left_joint"),
        ("rh_p12_rn_a", "open", "rh_r1_joint"),
    ],
)
def test_a_gripper_state_without_the_grippers_joint_is_refused(tmp_path, model, state, joint):
    folder = shutil.copytree(data_folder("robots") / model, tmp_path / "mine")
    path = folder / f"{model}.srdf"
    before, mark, after = path.read_text().partition(f'<group_state name="{state}"')
    removed = re.sub(r"<joint .*/>", "", after, count=1)
    path.write_text(before + mark + removed)
    with pytest.raises(SpecError, match=rf"srdf:\d+:\d+: state '{state}' .* '{joint}'"):
        load_robot(RobotSpec.model_validate({"model": "mine"}), tmp_path)
    path.write_text(before + mark + after.replace(f'"{joint}"', '"thumb"', 1))
    with pytest.raises(SpecError, match=r"srdf:\d+:\d+: state .* no joint 'thumb'"):
        load_robot(RobotSpec.model_validate({"model": "mine"}), tmp_path)


def test_without_the_mesh_package_arms_are_drawn_from_primitives(monkeypatch):
    with_meshes = robot(model="ur3e")
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    without = robot(model="ur3e", args={"safety_k_position": 20})  # another cache entry
    mesh_links = [x.name for x in without.links for v in x.visuals if hasattr(v.geometry, "path")]
    assert mesh_links == []
    assert all(link.visuals for link in without.links if link.collisions)
    assert [link.name for link in with_meshes.links] == [link.name for link in without.links]


def test_the_urdf_names_no_folder_of_this_machine():
    text = robot(model="ur3e", gripper="rh_p12_rn_a").urdf
    assert str(data_folder("robots").parent) not in text
    assert "site-packages" not in text


def test_loading_a_robot_imports_no_solver():
    code = (
        "import sys; from harness.robot.load import load_robot; "
        "from harness.language.scenario import RobotSpec; load_robot(RobotSpec(model='ur3e')); "
        "print([m for m in ('pinocchio', 'mujoco', 'coal', 'ompl') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
