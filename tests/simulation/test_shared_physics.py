"""Physics that cases share: the same bits, until something that differs touches something."""

import numpy as np
import pytest

from harness.core import sharing
from harness.simulation.model import build_model
from harness.simulation.mujoco_simulator import MujocoSimulator
from harness.simulation.shared_physics import _model_key
from harness.simulation.snapshot import CHANGED_IN_PLACE
from tests.simulation.physics_scenes import a_box, a_cylinder
from tests.simulation.test_determinism import assert_equal_bits


@pytest.fixture
def folder():
    sharing.open_folder()
    yield
    sharing.close_folder()


def grip(description, friction=1.0, mass=0.1):
    """A grip of a cylinder on a rough table; with it, the samples taken from earlier runs."""
    tally = sharing.begin()
    objects = (
        a_box("table", (0.4, 0.4, 0.02), (0, 0, 0.06), friction=0.5),
        a_cylinder("cylinder", 0.02, 0.1, (0, 0, 0.12), mass=mass, friction=friction),
    )
    simulator = MujocoSimulator(description, objects, ("table", "cylinder"))
    simulator.hold(0.1)
    simulator.command_gripper(1.0, 2.0, timeout=2.0)
    simulator.hold(0.1)
    return simulator.finish(), tally.taken["physics"]


def first_touch(signals):
    pairs = [force for (link, _), force in signals.contact_forces.items() if "rh_p12" in link]
    return min(int(np.argmax(force > 0)) for force in pairs)


@pytest.mark.usefixtures("folder")
def test_a_run_goes_with_others_until_the_fingers_touch(gripper_over_table):
    runs = [grip(gripper_over_table, friction) for friction in (0.8, 0.9, 1.0, 0.4)]
    sharing.close_folder()
    alone = [grip(gripper_over_table, friction)[0] for friction in (0.8, 0.9, 1.0, 0.4)]
    for (signals, _), other in zip(runs, alone, strict=True):
        assert_equal_bits(signals, other)
    touch = first_touch(alone[2])
    assert runs[0][1] == runs[1][1] == 0  # the second keeps what it has in common with the first
    assert touch - 110 < runs[2][1] <= touch  # a motion is shared in pieces of at most 0.1 s
    assert runs[3][1] == 0  # less than the table's friction: what stands on it differs at once
    assert alone[1].joint_positions.tobytes() != alone[2].joint_positions.tobytes()


@pytest.mark.usefixtures("folder")
def test_an_equal_run_is_taken_whole_and_another_mass_is_not(gripper_over_table):
    taken = [grip(gripper_over_table, 0.8, mass)[1] for mass in (0.1, 0.1, 0.1, 0.2)]
    whole = len(grip(gripper_over_table, 0.8)[0].times) - 1
    assert taken == [0, 0, whole, 0]


def test_every_other_number_of_the_model_is_in_the_key(gripper_over_table):
    objects = (a_cylinder("cylinder", 0.02, 0.1, (0, 0, 0.12), mass=0.1, friction=1.0),)
    physics = build_model(
        gripper_over_table, objects, ("cylinder",), gravity=(0, 0, -9.8), timestep=0.001
    )
    model = physics.model
    key = _model_key(model)
    assert _model_key(model) == key
    changed = 0
    for name in dir(model):
        values = getattr(model, name) if not name.startswith("_") else None
        if not isinstance(values, np.ndarray) or not values.size or name in CHANGED_IN_PLACE:
            continue
        if values.dtype.kind not in "fiu" or name.startswith(("names", "bvh", "oct", "paths")):
            continue
        before = values.flat[0]
        values.flat[0] = before + 1
        assert _model_key(model) != key, name
        values.flat[0] = before
        changed += 1
    assert changed > 150
    for vector in (model.opt.gravity, model.opt.wind):
        vector[0] += 1.0
        assert _model_key(model) != key
        vector[0] -= 1.0
    model.opt.timestep = 0.002
    assert _model_key(model) != key
