"""What a planning group can hold of a pose."""

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.robot.task_space import TaskSpace
from tests.robot.models import robot

TURNED = {"roll": (0.3, 0.0, 0.0), "pitch": (0.0, 0.2, 0.0), "yaw": (0.0, 0.0, 0.4)}


@pytest.mark.parametrize(
    ("joints", "held", "has_choice"),
    [
        (2, "x y z", False),
        (3, "x y z", False),
        (4, "x y z pitch", False),
        (5, "x y z pitch roll", True),
        (6, "x y z pitch roll yaw", False),
        (7, "x y z pitch roll yaw", True),
    ],
)
def test_each_joint_holds_one_more_part_of_a_pose(joints, held, has_choice):
    space = TaskSpace.of_joints(joints)
    assert space.held == tuple(held.split())
    assert space.has_choice == has_choice
    assert space.holds_pose == ("yaw" in held)
    assert space.holds_tilt == ("roll" in held)
    assert space.holds_pitch == ("pitch" in held)


@pytest.mark.parametrize(
    ("joints", "counted"),
    [
        (3, {}),
        (4, {"pitch": 0.2}),
        (5, {"pitch": 0.2}),
        (6, {"roll": 0.3, "pitch": 0.2, "yaw": 0.4}),
    ],
)
def test_only_turns_that_the_group_can_choose_count(joints, counted):
    space = TaskSpace.of_joints(joints)
    for name, turn in TURNED.items():
        turned = SE3.from_xyz_rpy((0.1, 0.0, 0.0), turn)
        expected = counted.get(name, 0.0)
        assert space.turn_between(SE3.identity(), turned) == pytest.approx(expected, abs=1e-12)
    assert space.turn_between(SE3.identity(), SE3(np.eye(3), np.ones(3))) == 0.0


def rails(*axes):
    return {"mount": {"rail": [{"name": axis, "axis": axis, "range": [0, 1]} for axis in axes]}}


@pytest.mark.parametrize(
    ("model", "mount", "held", "has_choice"),
    [
        ("open_manipulator_x", {}, "x y z pitch", False),
        ("open_manipulator_x", rails("z"), "x y z pitch", True),  # the arm lifts without it
        ("open_manipulator_x", rails("x", "y"), "x y z pitch roll", True),  # no axis rolls the tool
        ("ur5e", {}, "x y z pitch roll yaw", False),
        ("ur5e", rails("y"), "x y z pitch roll yaw", True),
    ],
)
def test_a_mechanism_holds_as_many_parts_as_it_can_move(model, mount, held, has_choice):
    description = robot(model=model, **mount)
    space = description.task_space(description.arm_group)
    assert (space.held, space.has_choice) == (tuple(held.split()), has_choice)


SCARA = """<robot name="scara"><link name="base"/>{links}</robot>"""


def serial_arm(tmp_path, *joints):
    links, parent = "", "base"
    for index, (kind, axis, x, z) in enumerate(joints):
        inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        links += f"""<link name="l{index}"><inertial><mass value="1"/>{inertia}</inertial></link>
          <joint name="j{index}" type="{kind}"><parent link="{parent}"/><child link="l{index}"/>
          <origin xyz="{x} 0 {z}"/><axis xyz="{axis}"/>
          <limit lower="-1.5" upper="1.5" velocity="1" effort="50"/></joint>"""
        parent = f"l{index}"
    path = tmp_path / "arm.urdf"
    path.write_text(SCARA.format(links=links), encoding="utf-8")
    return robot(urdf=str(path))


@pytest.mark.parametrize(
    ("joints", "held", "has_choice"),
    [
        # a SCARA moves its tool in four ways
        ([("revolute", "0 0 1", 0, 0.3), ("revolute", "0 0 1", 0.3, 0),
          ("prismatic", "0 0 1", 0.3, 0), ("revolute", "0 0 1", 0, 0)], "x y z pitch", False),
        # six joints in one plane move it in three
        ([("revolute", "0 1 0", 0, 0.2)] * 6, "x y z", True),
        # three axes of a gantry and a wrist of two
        ([("prismatic", "1 0 0", 0, 0), ("prismatic", "0 1 0", 0, 0), ("prismatic", "0 0 1", 0, 0),
          ("revolute", "0 0 1", 0, 0), ("revolute", "0 1 0", 0.1, 0)], "x y z pitch roll", True),
        # two joints on one axis count once
        ([("revolute", "0 0 1", 0, 0.2), ("revolute", "0 0 1", 0, 0.2),
          ("revolute", "0 1 0", 0, 0.2), ("revolute", "0 1 0", 0.3, 0),
          ("revolute", "0 1 0", 0.3, 0)], "x y z pitch", True),
    ],
)  # fmt: skip
def test_mechanisms_of_other_kinds(joints, held, has_choice, tmp_path):
    description = serial_arm(tmp_path, *joints)
    space = description.task_space(description.arm_group)
    assert (space.held, space.has_choice) == (tuple(held.split()), has_choice)
