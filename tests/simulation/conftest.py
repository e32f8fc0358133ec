"""Robots that the physics tests share."""

import numpy as np
import pytest

from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot


@pytest.fixture(scope="session")
def ur3e():
    """UR3e with the RH-P12-RN(A), 5 mm above a table top at 1.015 m, as in the lesson."""
    base = {"xyz": [0, 0, 1.02]}
    return load_robot(RobotSpec(model="ur3e", gripper="rh_p12_rn_a", base=base))


@pytest.fixture(scope="session")
def gripper_over_table():
    """The gripper on no arm, pointing down at a cylinder whose middle is at z = 0.12."""
    base = {"xyz": [0, 0, 0.275], "rpy": [np.pi, 0, 0]}
    return load_robot(RobotSpec(model="rh_p12_rn_a", base=base))


@pytest.fixture(scope="session")
def open_manipulator():
    return load_robot(RobotSpec(model="open_manipulator_x"))
