"""What a planning group can hold of a pose."""

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.robot.task_space import TaskSpace

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
