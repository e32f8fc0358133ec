"""The same calls give the same bits, whatever ran before and in whatever pieces time goes on."""

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.simulation.physics_scenes import ABOVE, AT_CYLINDER, a_box, a_cylinder, move_arm


def a_run(description, pieces=1):
    objects = (
        a_box("Table", (1.5, 1.6, 0.03), (0.4, 0, 1.0), friction=0.6),
        a_cylinder("cylinder", 0.03, 0.1, (0.32, -0.168, 1.065), mass=0.1, friction=30.0),
        a_box("later", (0.05, 0.05, 0.1), (0.36, 0.2, 1.065), mass=0.3),
    )
    simulator = MujocoSimulator(description, objects, ("Table", "cylinder"))
    move_arm(simulator, ABOVE, 1.0)
    simulator.add_object("later", SE3.from_xyz_rpy((0.36, 0.2, 1.07)))
    move_arm(simulator, AT_CYLINDER, 1.0)
    simulator.command_gripper(0.59, 2.0, timeout=5.0)
    for _ in range(pieces):
        simulator.hold(0.2 / pieces)
    move_arm(simulator, ABOVE, 1.0)
    return simulator.finish()


def assert_equal_bits(first, second):
    for name, values in vars(first).items():
        others = getattr(second, name)
        if isinstance(values, dict):
            assert list(values) == list(others)
            for key, value in values.items():
                assert value.tobytes() == others[key].tobytes(), (name, key)
        elif isinstance(values, np.ndarray):
            assert values.tobytes() == others.tobytes(), name


@pytest.fixture(scope="module")
def first(ur3e):
    return a_run(ur3e)


def test_two_runs_are_equal_to_the_bit(first, ur3e, gripper_over_table):
    MujocoSimulator(gripper_over_table, (), ()).command_gripper(1.0, 2.0, timeout=2.0)
    assert_equal_bits(first, a_run(ur3e))


@pytest.mark.nightly
def test_time_in_pieces_is_the_same_time(first, ur3e):
    assert_equal_bits(first, a_run(ur3e, pieces=20))
