"""Suction cups in the physics: what they hold, and where their rims leak."""

import numpy as np
import pytest

from harness.core.geometry import Box, Cylinder, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.language.scenario import RobotSpec
from harness.plugins.studio.live_simulator import LiveSimulator
from harness.robot.load import load_robot
from tests.simulation.physics_scenes import a_box

RADIUS, LIP, VACUUM, FRICTION = 0.02, 0.0015, 60000.0, 0.5  # robots/suction_cup/robot.yaml
FORCE = VACUUM * np.pi * RADIUS**2
RIM = 0.43  # height of the rim [m]
GAP = 0.0005  # between rim and object before the suction is on [m]
PAD = "suction_pad"


def cup(rpy=(np.pi, 0, 0), xyz=(0, 0, RIM + 0.07), model="suction_cup"):
    return load_robot(RobotSpec(model=model, base={"xyz": list(xyz), "rpy": list(rpy)}))


@pytest.fixture(scope="module")
def downwards():
    return cup()


def hang(robot, obj, *, hold=0.4, table=None):
    """Switch the suction on over an object on a support, take the support away, and wait."""
    lowest = obj.pose.translation[2] - 0.02
    support = table or a_box("table", (0.6, 0.6, 0.1), (0, 0, lowest - 0.05))
    simulator = LiveSimulator(robot, (support, obj), ("table", obj.name))
    simulator.hold(0.02)
    result = simulator.command_gripper(0.005, 5.0, timeout=2)
    simulator.remove_object("table")
    simulator.hold(hold)
    return simulator, result


def a_plate(mass, at=(0.0, 0.0), size=(0.1, 0.1, 0.04)):
    return a_box("plate", size, (*at, RIM - GAP - size[2] / 2), mass=mass)


def fallen(simulator, name="plate"):
    return RIM - simulator.object_pose(name).translation[2] > 0.1


@pytest.mark.parametrize(("share", "holds"), [(0.5, True), (0.99, True), (1.01, False)])
def test_a_cup_holds_vacuum_times_area(downwards, share, holds):
    simulator, result = hang(downwards, a_plate(share * FORCE / 9.8))
    assert result.between == ("plate",)
    assert fallen(simulator) is not holds
    if holds:
        signals = simulator.finish()
        assert signals.pulls[PAD, "plate"][-1] == pytest.approx([0, 0, FORCE, 4], rel=1e-9)
        rim = signals.contact_forces[PAD, "plate"][-50:].mean()
        assert rim == pytest.approx((1 - share) * FORCE, rel=1e-3)


@pytest.mark.parametrize(("share", "holds"), [(0.97, True), (1.03, False)])
def test_a_cup_on_a_side_holds_what_friction_allows(share, holds):
    robot = cup(rpy=(0, np.pi / 2, 0), xyz=(-0.07, 0, 0.5))  # the rim is at x = 0
    size = (0.002, 0.1, 0.1)  # thin: its weight has no lever
    plate = a_box("plate", size, (GAP + 0.001, 0, 0.5), mass=share * FRICTION * FORCE / 9.8)
    table = a_box("table", (0.1, 0.1, 0.1), (0.03, 0, 0.4))
    simulator, _ = hang(robot, plate, table=table)
    sunk = 0.5 - simulator.object_pose("plate").translation[2]
    assert bool(sunk < 0.002) is holds
    if holds:
        friction = simulator.finish().frictions[PAD, "plate"][-50:, 2].mean()
        assert friction == pytest.approx(share * FRICTION * FORCE, rel=0.01)


@pytest.mark.parametrize(("share", "holds"), [(0.95, True), (1.05, False)])
def test_a_load_off_the_middle_peels_the_cup_off(downwards, share, holds):
    weight = 0.3 * FORCE
    # The rim tips about its point on the far side when weight times lever is (F - W) R.
    lever = share * (FORCE - weight) * RADIUS / weight
    simulator, result = hang(downwards, a_plate(weight / 9.8, (lever, 0), (0.24, 0.1, 0.04)))
    assert result.between == ("plate",)
    assert fallen(simulator) is not holds


@pytest.mark.parametrize(
    ("at", "quarters"),
    [((0.0, 0.0), 4), ((0.04, 0.0), 2), ((0.042, 0.042), 1), ((0.028, 0.0), 4), ((0.08, 0), 0)],
)
def test_a_cup_over_an_edge_holds_nothing(downwards, at, quarters):
    simulator, result = hang(downwards, a_plate(0.1, at), hold=0.2)
    assert (result.between == ("plate",)) is (quarters == 4)
    if quarters < 4:
        expected = f"{quarters} of 4 quarters of the rim touch" if quarters else "touches nothing"
        assert expected in result.unsealed["cup"]
        assert fallen(simulator)


def a_ring(hole, mass=0.1):
    """A plate of four boxes around a square hole."""
    wide = 0.06 - hole / 2
    away = hole / 2 + wide / 2
    parts = [
        Shape(Box((wide, 0.12, 0.04)), SE3.from_xyz_rpy((away, 0, 0))),
        Shape(Box((wide, 0.12, 0.04)), SE3.from_xyz_rpy((-away, 0, 0))),
        Shape(Box((hole, wide, 0.04)), SE3.from_xyz_rpy((0, away, 0))),
        Shape(Box((hole, wide, 0.04)), SE3.from_xyz_rpy((0, -away, 0))),
    ]
    inertia = mass * np.diag([2e-3, 2e-3, 3e-3])
    pose = SE3.from_xyz_rpy((0, 0, RIM - GAP - 0.02))
    return WorldObject("plate", tuple(parts), pose, False, mass, np.zeros(3), inertia)


@pytest.mark.parametrize(("hole", "shift"), [(0.016, 0.0), (0.02, 0.004), (0.001, 0.0)])
def test_a_cup_over_a_hole_holds_nothing(downwards, hole, shift):
    ring = a_ring(hole)
    ring.pose.translation[0] += shift
    simulator, result = hang(downwards, ring, hold=0.2)
    assert fallen(simulator)
    assert "air enters inside it" in result.unsealed["cup"]


@pytest.mark.parametrize(("share", "holds"), [(0.7, True), (1.3, False)])
def test_a_cup_bends_on_a_slope_as_far_as_its_lip_reaches(share, holds):
    tilt = share * LIP / (2 * RADIUS)
    robot = cup(rpy=(np.pi + tilt, 0, 0))
    # The lowest point of the rim touches; the highest is 2 R sin(tilt) above the plate.
    lowest = RIM + 0.07 - 0.07 * np.cos(tilt) - RADIUS * np.sin(tilt)
    plate = a_box("plate", (0.1, 0.1, 0.04), (0, 0, lowest - 0.02 - 1e-5), mass=0.1)
    simulator, result = hang(robot, plate, hold=0.2)
    assert (result.between == ("plate",)) is holds
    assert fallen(simulator) is not holds


def a_solid(geometry, z, mass=0.1):
    inertia = mass * 1e-3 * np.eye(3)
    pose = SE3.from_xyz_rpy((0, 0, z))
    return WorldObject("plate", (Shape(geometry),), pose, False, mass, np.zeros(3), inertia)


@pytest.mark.parametrize(("radius", "holds"), [(0.06, True), (0.045, False), (0.019, False)])
def test_a_cup_holds_a_sphere_that_fits_into_its_depth(downwards, radius, holds):
    sunk = radius - np.sqrt(max(radius**2 - RADIUS**2, 0.0))
    ball = a_solid(Sphere(radius), RIM - GAP - radius + sunk)
    table = a_box("table", (0.6, 0.6, 0.1), (0, 0, ball.pose.translation[2] - radius - 0.05))
    _, result = hang(downwards, ball, hold=0.2, table=table)
    assert (result.between == ("plate",)) is holds


def test_the_side_of_a_thin_cylinder_leaks(downwards):
    lying = a_solid(Cylinder(0.03, 0.2), RIM - GAP - 0.03)
    lying = WorldObject(
        "plate", (Shape(Cylinder(0.03, 0.2), SE3.from_xyz_rpy(rpy=(np.pi / 2, 0, 0))),),
        lying.pose, False, 0.1, np.zeros(3), lying.inertia,
    )  # fmt: skip
    table = a_box("table", (0.6, 0.6, 0.1), (0, 0, lying.pose.translation[2] - 0.08))
    _, result = hang(downwards, lying, hold=0.1, table=table)
    assert result.between == ()
    assert "0 of 4" in result.unsealed["cup"] or "touches" in result.unsealed["cup"]


def test_what_is_switched_off_falls(downwards):
    simulator, result = hang(downwards, a_plate(0.5), hold=0.1)
    assert result.between == ("plate",)
    result = simulator.command_gripper(0.0, 5.0, timeout=2)
    assert result.between == ()
    simulator.hold(0.3)
    assert fallen(simulator)


def test_the_forces_on_cup_and_object_are_opposite(downwards):
    """The base is fixed: the whole cell's weight is that of the plate, held or standing."""
    simulator, _ = hang(downwards, a_plate(2.0))
    signals = simulator.finish()
    pull, friction = signals.pulls[PAD, "plate"][-1, :3], signals.frictions[PAD, "plate"][-1]
    press = signals.presses[PAD, "plate"][-1, 3:]
    assert pull + friction + press == pytest.approx([0, 0, 2.0 * 9.8], abs=0.02)


def test_each_cup_of_an_array_leaks_alone():
    robot = cup(model="suction_array")
    radius = 0.015
    simulator, result = hang(robot, a_plate(0.5, (0.028, 0), (0.1, 0.12, 0.04)))
    assert result.between == ("plate",)
    assert sorted(result.unsealed) == ["back_left", "back_right"]
    pulls = simulator.finish().pulls
    held = [key[0] for key, rows in pulls.items() if rows[-1, 2] > 0]
    assert held == ["suction_pad_front_left", "suction_pad_front_right"]
    total = sum(rows[-1, 2] for rows in pulls.values())
    assert total == pytest.approx(2 * VACUUM * np.pi * radius**2, rel=1e-6)


def test_a_restored_simulator_holds_as_its_snapshot_did(downwards):
    simulator, _ = hang(downwards, a_plate(1.0), hold=0.1)
    state = simulator.snapshot()
    simulator.hold(0.2)
    first = simulator.finish()
    simulator.command_gripper(0.0, 5.0, timeout=2)
    simulator.restore(state)
    simulator.hold(0.2)
    again = simulator.finish()
    assert np.array_equal(again.object_poses["plate"], first.object_poses["plate"], equal_nan=True)
    assert np.array_equal(again.pulls[PAD, "plate"], first.pulls[PAD, "plate"])
