"""Forces of the recorded contacts, also of those that touch and press on nothing."""

import mujoco
import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from harness.simulation.contact_record import ContactRecord
from harness.simulation.model import build_model
from harness.simulation.mujoco_simulator import MujocoSimulator
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
    record = ContactRecord(physics, data)
    record.keep()
    forces = record.forces(0, 1)
    expected, wrench = dict.fromkeys(forces, 0.0), np.zeros(6)
    for index in range(data.ncon):
        bodies = physics.model.geom_bodyid[data.contact.geom[index]]
        mujoco.mj_contactForce(physics.model, data, index, wrench)
        expected[tuple(sorted(physics.body_names[body] for body in bodies))] += wrench[0]
    assert {pair: float(force[0]) for pair, force in forces.items()} == pytest.approx(expected)
    assert expected["a floor", "pressed"] > 1.0
    assert expected["a floor", "box"] == 0.0


@pytest.mark.parametrize("block", [1, 100, 2**19])
def test_sums_of_the_contacts_are_those_of_a_plain_loop_over_them(
    gripper_over_table, monkeypatch, block
):
    """Of a grid of boxes, with one that lies on two others and one under the gripper."""
    monkeypatch.setattr("harness.simulation.contact_record.BLOCK", block)
    monkeypatch.setattr("harness.simulation.contact_record.AT_ONCE", 7)
    grid = [
        a_box(f"box {row} {column}", (0.1, 0.1, 0.05), (row, column, 0.0245), mass=0.3)
        for row in range(1, 5)
        for column in range(-2, 3)
    ]
    world = [
        FLOOR,
        *grid,
        a_box("left", (0.1, 0.1, 0.1), (-1, 0, 0.0499), mass=1.0),
        a_box("right", (0.1, 0.1, 0.1), (-1, 0.2, 0.0499), mass=1.0),
        a_box("bridge", (0.1, 0.4, 0.02), (-1, 0.1, 0.1097), mass=0.5),
        a_box("gripped", (0.1, 0.1, 0.2), (0.0, 0.0, 0.0999), mass=0.5),
    ]
    physics = build_model(
        gripper_over_table,
        world,
        [each.name for each in world],
        gravity=(0.0, 0.0, -9.8),
        timestep=0.001,
    )
    data, samples = mujoco.MjData(physics.model), 20
    record, wrench = ContactRecord(physics, data), np.zeros(6)
    total, carried, pushed, rubbed = {}, {}, {}, {}
    for row in range(samples):
        mujoco.mj_step(physics.model, data)
        record.keep()
        for index in range(data.ncon):
            mujoco.mj_contactForce(physics.model, data, index, wrench)
            bodies = physics.model.geom_bodyid[data.contact.geom[index]].tolist()
            names = [physics.body_names[body] for body in bodies]
            links = [body in physics.robot_bodies for body in bodies]
            axes = data.contact.frame[index].reshape(3, 3)
            force = wrench[0] * axes[0]  # of the first on the second
            friction = wrench[1:3] @ axes[1:]
            if links == [False, True] or (links[0] == links[1] and names[0] > names[1]):
                names, force, friction = names[::-1], -force, -friction
            pair = (names[0], names[1])
            total.setdefault(pair, np.zeros(samples))[row] += wrench[0]
            if not any(links):
                carried.setdefault(pair, np.zeros(samples))[row] += force[2]
            if links[0] != links[1]:
                pushed.setdefault(pair, np.zeros((samples, 3)))[row] += force
                rubbed.setdefault(pair, np.zeros((samples, 3)))[row] += friction
    assert ("bridge", "left") in carried
    assert pushed
    assert any(np.abs(friction).max() > 1e-3 for friction in rubbed.values())
    for found, expected in (
        (record.forces(0, samples), total),
        (record.support_forces(0, samples), carried),
        ({pair: press[:, 3:] for pair, press in record.presses(0, samples).items()}, pushed),
        (record.frictions(0, samples), rubbed),
    ):
        assert list(found) == sorted(expected)
        for pair, values in found.items():
            assert np.nan_to_num(values) == pytest.approx(expected[pair], rel=1e-5, abs=1e-6)
    late = record.forces(samples - 5, samples)
    assert all(late[pair] == pytest.approx(total[pair][-5:]) for pair in late)


def test_a_world_without_contacts_has_no_forces(gripper_over_table):
    signals = MujocoSimulator(gripper_over_table, [], ()).finish()
    assert (signals.contact_forces, signals.support_forces, signals.presses) == ({}, {}, {})
    assert signals.frictions == {}


@pytest.mark.parametrize(
    ("name", "velocity", "turning", "expected"),
    [
        ("box", (0.2, 0.1, 0), (0, 0, 0), np.hypot(0.2, 0.1)),
        ("box", (0, 0, 0), (0, 0, 2.0), 2.0 * 0.025 * np.sqrt(2)),  # the way of its corners
        ("cylinder", (0.3, 0, 0), (0, 0, 0), 0.3),
        ("sphere", (0.3, 0, 0), (0, 10.0, 0), 0),  # it rolls
        ("sphere", (0, 0, 0), (0, 0, 5.0), 0),  # it spins about the point that touches
        ("box", (0, 0, 0.3), (0, 0, 0), 0),  # it leaves
    ],
)
def test_objects_slide_as_far_as_the_points_at_which_they_touch(
    gripper_over_table, name, velocity, turning, expected
):
    world, timestep, samples = [FLOOR, resting(name)], 1e-3, 30
    physics = build_model(
        gripper_over_table,
        world,
        [each.name for each in world],
        gravity=(0.0, 0.0, -9.8),
        timestep=timestep,
    )
    data, place = mujoco.MjData(physics.model), physics.objects[name]
    record, poses = ContactRecord(physics, data), np.empty((samples, 7))
    data.qpos[place.qpos + 2] -= 2e-4  # into the soft floor, so that all corners press
    for row in range(samples):
        data.qvel[place.dof : place.dof + 6] = *velocity, *turning
        mujoco.mj_forward(physics.model, data)
        record.keep()
        poses[row] = data.qpos[place.qpos : place.qpos + 7]
        mujoco.mj_integratePos(physics.model, data.qpos, data.qvel, timestep)
    floor = np.tile(FLOOR.pose.as_vector(), (samples, 1))
    every = {name: poses, "a floor": floor}
    assert record.slides(0, samples, every, set(), {}) == {}
    (slid,) = record.slides(0, samples, every, {name}, {}).values()
    assert slid[0] == 0
    assert slid[1:] == pytest.approx(np.full(samples - 1, expected * timestep), abs=2e-6)
