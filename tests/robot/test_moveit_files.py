"""MoveIt's joint_limits.yaml and kinematics.yaml."""

import numpy as np
import pytest

from harness.core.errors import RobotError, SpecError
from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.ports.goals import PoseGoal
from harness.robot.load import load_robot
from tests.robot.arm_files import URDF, load_arm, write_arm

LIMITS = """\
default_velocity_scaling_factor: 0.1
joint_limits:
  shoulder_pan_joint:
    has_velocity_limits: true
    max_velocity: 1.5
    has_acceleration_limits: true
    max_acceleration: 2.5
  elbow_joint:
    has_velocity_limits: false
    max_velocity: 0.1
    has_position_limits: true
    min_position: -1.0
    max_position: 2
  wrist_1_joint: {has_velocity_limits: true, max_velocity: 100.0}
"""
KINEMATICS = """\
ur_manipulator:
  kinematics_solver: kdl_kinematics_plugin/KDLKinematicsPlugin
  kinematics_solver_timeout: 0.005
  position_only_ik: {only}
"""


def load(folder, **files):
    words = {}
    for key, text in files.items():
        (folder / f"{key}.yaml").write_text(text, encoding="utf-8")
        words[key] = f"{key}.yaml"
    return load_robot(RobotSpec.model_validate({"model": "ur5e", "moveit": words}), folder)


@pytest.mark.parametrize(
    "wrapper", ["", "/**:\n ros__parameters:\n  robot_description_planning:\n"]
)
def test_joint_limits_narrow_the_robots_own(tmp_path, wrapper):
    indent = "   " if wrapper else ""
    text = wrapper + "".join(f"{indent}{line}\n" for line in LIMITS.splitlines())
    arm = load(tmp_path, joint_limits=text)
    pan, elbow, wrist = (
        arm.joint_by_name[f"{name}_joint"] for name in ("shoulder_pan", "elbow", "wrist_1")
    )
    assert (pan.velocity, pan.acceleration) == (1.5, 2.5)
    assert (elbow.lower, elbow.upper) == (-1.0, 2.0)
    assert elbow.velocity > 3, "has_velocity_limits is false"
    assert wrist.velocity < 4
    assert any("wrist_1_joint has a wider velocity limit" in note for note in arm.notes)
    assert 'upper="2.0"' in arm.urdf


@pytest.mark.parametrize(
    ("tagged", "position", "velocity"),
    [
        ("!degrees 150.0", np.deg2rad(150), np.deg2rad(90)),
        ("!degrees '150'", np.deg2rad(150), np.deg2rad(90)),
        ("!radians 1.25", 1.25, np.deg2rad(90)),
        ("!radians pi/2", np.pi / 2, np.deg2rad(90)),
    ],
)
def test_limits_with_the_tags_of_xacros_yaml_are_in_their_unit(
    tmp_path, tagged, position, velocity
):
    text = f"""joint_limits:
  elbow_joint: {{has_position_limits: true, min_position: !degrees -120, max_position: {tagged},
    has_velocity_limits: true, max_velocity: !degrees 90.0}}
"""
    joint = load(tmp_path, joint_limits=text).joint_by_name["elbow_joint"]
    assert (joint.upper, joint.velocity) == pytest.approx((position, velocity), abs=1e-12)
    assert joint.lower == pytest.approx(np.deg2rad(-120))


@pytest.mark.parametrize(
    ("tagged", "words"),
    [
        ("!degrees wide", "`wide` is not a number"),
        ("!degrees 1 rad", "`1 rad` has a unit and a tag"),
        ("!degrees [1, 2]", "`!degrees` is a tag"),
        ("!!python/object:os.system 1", "is a tag"),
    ],
)
def test_a_tag_with_something_else_is_refused_at_its_place(tmp_path, tagged, words):
    text = f"joint_limits:\n  elbow_joint:\n    max_velocity: {tagged}\n"
    with pytest.raises(SpecError) as caught:
        load(tmp_path, joint_limits=text)
    assert (caught.value.problems[0].line, caught.value.problems[0].column) == (3, 19)
    assert words in caught.value.problems[0].message


def test_limits_that_are_assumed_give_way_to_those_of_a_file(tmp_path):
    """A velocity of 0 in the URDF is none; what is assumed instead must not narrow a real limit."""
    write_arm(tmp_path, URDF.replace('velocity="0.3"', 'velocity="0"'))
    assert load_arm(tmp_path).joint_by_name["reach"].velocity == 0.2
    given = "{has_velocity_limits: true, max_velocity: 1.0, has_acceleration_limits: true,"
    given += " max_acceleration: 0.5}"
    text = "joint_limits:\n" + "".join(f"  {n}: {given}\n" for n in ("turn", "bend", "reach"))
    (tmp_path / "joint_limits.yaml").write_text(text, encoding="utf-8")
    arm = load_arm(tmp_path, moveit={"joint_limits": "joint_limits.yaml"})
    assert [arm.joint_by_name[name].velocity for name in ("turn", "bend", "reach")] == [1, 1, 1]
    assert not [note for note in arm.notes if "assumed" in note or "wider" in note]
    limits = {"reach": {"max_velocity": 0.7, "max_acceleration": 2.0}}
    stated = load_arm(tmp_path, joint_limits=limits)
    assert stated.joint_by_name["reach"].velocity == 0.7
    assert stated.notes[-1] == "no acceleration limits of turn, bend: 5 rad/s^2 are assumed"
    with pytest.raises(RobotError, match="max_velocity: 3 is more than the robot's 2;"):
        load_arm(tmp_path, joint_limits={"turn": {"max_velocity": 3.0}})


def test_what_is_assumed_for_an_arm_without_efforts_is_listed(tmp_path):
    write_arm(tmp_path, URDF.replace(' effort="30"', "").replace(' effort="80"', ""))
    assert load_arm(tmp_path).notes == (
        "no acceleration limits: 5 rad/s^2 and 1 m/s^2 are assumed",
    )


@pytest.mark.parametrize("only", ["true", "false"])
def test_position_only_ik_frees_the_orientation(tmp_path, only):
    arm = load(tmp_path, kinematics=KINEMATICS.format(only=only))
    kinematics = PinocchioKinematics(arm)
    # A point at the edge of the reach, looking back at the arm: to be reached, but not like that.
    goal = PoseGoal("tool0", SE3.from_xyz_rpy((0.75, 0.2, 0.3), (0, -np.pi / 2, 0)))
    start = arm.start_positions()
    solutions = kinematics.solve("ur_manipulator", goal, start, 1)
    assert bool(solutions) == (only == "true")
    for positions in solutions:
        there = kinematics.link_pose(positions, "tool0").translation
        assert there == pytest.approx(goal.pose.translation, abs=1e-4)


@pytest.mark.parametrize(
    ("files", "words"),
    [
        (
            {"joint_limits": LIMITS.replace("elbow_joint", "elbo_joint")},
            ["joint_limits.yaml:8:3", "no joint 'elbo_joint'", "did you mean `elbow_joint`"],
        ),
        ({"joint_limits": LIMITS.replace("1.5", "fast")}, ["joint_limits.yaml:5:19", "'fast'"]),
        ({"joint_limits": LIMITS.replace("1.5", "-1")}, [":5:19", "above zero"]),
        ({"joint_limits": LIMITS.replace("-1.0", "5")}, [":9:5", "nothing is between 5 and 2"]),
        ({"joint_limits": "joints: {}"}, ["no joint_limits.yaml", "no key `joint_limits`"]),
        ({"kinematics": KINEMATICS.format(only="yes")}, [":4:21", "true or false"]),
        (
            {"kinematics": "arm: {kinematics_solver: x}"},
            ["kinematics.yaml:1:1", "no group 'arm'", "ur_manipulator"],
        ),
    ],
)
def test_what_the_robot_has_not_is_reported_at_its_place(tmp_path, files, words):
    with pytest.raises(SpecError) as caught:
        load(tmp_path, **files)
    for word in words:
        assert word in str(caught.value)


def test_a_file_that_is_not_there_is_reported(tmp_path):
    words = {"model": "ur5e", "moveit": {"kinematics": "gone.yaml"}}
    with pytest.raises(RobotError, match="moveit: there is no file"):
        load_robot(RobotSpec.model_validate(words), tmp_path)
