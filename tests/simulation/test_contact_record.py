"""Forces of the recorded contacts, also of those that touch and press on nothing."""

import mujoco
import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.robot.load import load_robot
from harness.simulation.contact_record import ContactRecord
from harness.simulation.model import build_model
from harness.simulation.mujoco_simulator import MujocoSimulator
from harness.spec.scenario import RobotSpec
from tests.simulation.physics_scenes import a_box

RESTING = {
    "box": (Box((0.05, 0.05, 0.05)), 0.025),
    "sphere": (Sphere(0.03), 0.03),
    "cylinder": (Cylinder(0.03, 0.1), 0.05),
    "capsule": (Capsule(0.03125, 0.0625), 0.0625),
}
FLOOR = WorldObject(
    "a floor", (Shape(Plane()),), SE3.identity(), True, 0.0, np.zeros(3), np.zeros((3, 3))
)


def resting(name, x=1.5):
    geometry, height = RESTING[name]
    pose, inertia = SE3.from_xyz_rpy((x, 0.0, height)), 1e-4 * np.eye(3)
    return WorldObject(name, (Shape(geometry),), pose, False, 0.2, np.zeros(3), inertia)


def all_resting():
    return [FLOOR, *(resting(name, 1.5 + 0.3 * place) for place, name in enumerate(RESTING))]


@pytest.mark.parametrize("name", RESTING)
def test_an_object_that_rests_exactly_on_the_floor_is_recorded(name):
    arm = load_robot(RobotSpec(model="ur5e"))
    simulator = MujocoSimulator(arm, [FLOOR, resting(name)], ("a floor", name))
    simulator.hold(1.0)
    force = simulator.finish().contact_forces["a floor", name]
    assert force[0] == 0.0
    assert force[-1] == pytest.approx(0.2 * 9.8, rel=1e-2)


@pytest.mark.parametrize("robot", ["ur3", "ur10e", "ur16e"])
def test_where_everything_only_touches_no_force_is_recorded(robot):
    world = all_resting()
    arm = load_robot(RobotSpec(model=robot))
    signals = MujocoSimulator(arm, world, [each.name for each in world]).finish()
    assert set(signals.contact_forces) == {("a floor", name) for name in RESTING}
    assert all(force == [0.0] for force in signals.contact_forces.values())
    assert all(force == [0.0] for force in signals.support_forces.values())


def test_a_contact_that_only_touches_does_not_take_the_force_of_another_constraint(
    gripper_over_table,
):
    """The first constraint of a gripper is its coupling, not a contact."""
    world = [*all_resting(), a_box("pressed", (0.2, 0.2, 0.1), (9, 0, 0.0499), mass=1.0)]
    names = [each.name for each in world]
    physics = build_model(
        gripper_over_table, world, names, gravity=(0.0, 0.0, -9.8), timestep=0.001
    )
    data = mujoco.MjData(physics.model)
    mujoco.mj_forward(physics.model, data)
    data.efc_force[0] = 123.0
    record = ContactRecord(physics)
    record.keep(data, 0)
    forces = record.forces(0, 1)
    expected, wrench = dict.fromkeys(forces, 0.0), np.zeros(6)
    for index in range(data.ncon):
        bodies = physics.model.geom_bodyid[data.contact.geom[index]]
        mujoco.mj_contactForce(physics.model, data, index, wrench)
        expected[tuple(sorted(physics.body_names[body] for body in bodies))] += wrench[0]
    assert {pair: float(force[0]) for pair, force in forces.items()} == pytest.approx(expected)
    assert expected["a floor", "pressed"] > 1.0
    assert expected["a floor", "box"] == 0.0
