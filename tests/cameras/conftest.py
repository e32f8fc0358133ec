"""The robot of the camera tests."""

import pytest

from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot


@pytest.fixture(scope="session")
def ur3e():
    return load_robot(RobotSpec(model="ur3e", gripper="rh_p12_rn_a"))
