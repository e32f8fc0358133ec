"""Objects at rest fall asleep in MuJoCo; what is recorded, and what follows, stays the same."""

# pyright: reportAttributeAccessIssue=false

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.plugins.faults.injection import Injection
from harness.plugins.studio.live_simulator import LiveSimulator
from tests.simulation.physics_scenes import a_box, a_cylinder
from tests.simulation.test_determinism import assert_equal_bits

SLOPE = np.radians(20)


def a_stack():
    """A box on a box on a board, with a cylinder next to them, away from the gripper."""
    return (
        a_box("board", (0.6, 0.6, 0.02), (0.6, 0, 0.06), friction=0.6),
        a_box("lower", (0.06, 0.06, 0.06), (0.6, 0, 0.1), mass=0.2),
        a_box("upper", (0.04, 0.04, 0.04), (0.6, 0, 0.15), mass=0.1),
        a_cylinder("cylinder", 0.03, 0.1, (0.6, 0.2, 0.12), mass=0.1),
    )


def a_slope():
    board = a_box("board", (0.6, 0.6, 0.02), (0.6, 0, 0.1), friction=1.0)
    box = a_box("box", (0.05, 0.05, 0.05), (0, 0, 0), mass=0.1, friction=1.0)
    tilted = SE3.from_xyz_rpy((0.6, 0, 0.1), (0, SLOPE, 0))
    on_it = tilted @ SE3.from_xyz_rpy((0, 0, 0.035))
    return replace(board, pose=tilted), replace(box, pose=on_it)


def simulator_of(description, objects, *, is_asleep=True, **options):
    """A simulator in which everything has come to rest, and asleep if it may."""
    simulator = LiveSimulator(description, objects, [obj.name for obj in objects], **options)
    if not is_asleep:
        simulator.physics.model.opt.enableflags = 0
    simulator.hold(2.0)
    assert (sleeping(simulator) > 0) == is_asleep
    return simulator


def sleeping(simulator):
    return simulator.physics.model.ntree - simulator.snapshot().step.counts[0]


def heights(simulator, name):
    return simulator.finish().object_poses[name][:, 2]


def test_contacts_of_what_is_asleep_are_recorded(gripper_over_table):
    asleep = simulator_of(gripper_over_table, a_stack())
    awake = simulator_of(gripper_over_table, a_stack(), is_asleep=False)
    assert sleeping(asleep) == 3
    first, second = asleep.finish(), awake.finish()
    assert first.contact_forces.keys() == second.contact_forces.keys()
    for pair, force in first.contact_forces.items():
        assert force[-500:] == pytest.approx(second.contact_forces[pair][-500:], rel=2e-3)
    for pair, force in first.support_forces.items():
        assert force[-500:] == pytest.approx(second.support_forces[pair][-500:], rel=2e-3)
    assert first.contact_forces["board", "lower"][-1] == pytest.approx(0.3 * 9.8, rel=1e-3)
    for name, poses in first.object_poses.items():
        assert poses == pytest.approx(second.object_poses[name], abs=3e-5)  # cylinders rock


@pytest.mark.parametrize("missing", ["board", "lower"])
def test_what_loses_its_support_falls(gripper_over_table, missing):
    simulator = simulator_of(gripper_over_table, a_stack())
    simulator.remove_object(missing)
    simulator.hold(0.1)
    assert heights(simulator, "upper")[-1] == pytest.approx(0.15 - 0.049, abs=2e-3)


def test_what_loses_its_support_to_a_motion_falls(gripper_over_table):
    simulator = simulator_of(gripper_over_table, a_stack())
    simulator.move_object("board", SE3.from_xyz_rpy((0.6, 2.0, 0.06)))
    simulator.hold(0.1)
    for name, height in (("upper", 0.15), ("lower", 0.1), ("cylinder", 0.12)):
        assert heights(simulator, name)[-1] == pytest.approx(height - 0.049, abs=2e-3)


def test_what_is_struck_by_a_falling_object_wakes(gripper_over_table):
    simulator = simulator_of(gripper_over_table, a_stack())
    first = simulator.sample_count
    simulator.move_object("cylinder", SE3.from_xyz_rpy((0.6, 0, 0.4)))
    simulator.hold(0.5)
    assert simulator.finish().contact_forces["board", "lower"][first:].max() > 5 * 0.3 * 9.8


def test_what_is_pushed_wakes(gripper_over_table):
    simulator = simulator_of(gripper_over_table, a_stack())
    Injection(simulator).push({"cylinder": np.array([0.0, 2.0, 0.0])}, 0.2)
    assert simulator.object_pose("cylinder").translation[1] > 0.25


def test_what_stands_on_a_slope_slides_when_it_becomes_slippery(gripper_over_table):
    simulator = simulator_of(gripper_over_table, a_slope())
    before = simulator.object_pose("box").translation.copy()
    simulator.hold(1.0)
    assert np.abs(simulator.object_pose("box").translation - before).max() < 1e-6
    Injection(simulator).set_friction("box", 0.05)
    Injection(simulator).set_friction("board", 0.05)
    simulator.hold(0.5)
    assert np.linalg.norm(simulator.object_pose("box").translation - before) > 0.1


def test_what_was_welded_to_a_body_at_rest_falls_when_it_is_released(gripper_over_table):
    simulator = simulator_of(gripper_over_table, a_stack())
    held = simulator.object_pose("upper").translation[2]
    simulator.weld("upper", "world")
    simulator.remove_object("lower")
    simulator.hold(1.0)
    assert simulator.object_pose("upper").translation[2] == pytest.approx(held, abs=1e-5)
    simulator.unweld("upper")
    simulator.hold(0.1)
    assert simulator.object_pose("upper").translation[2] == pytest.approx(0.15 - 0.049, abs=2e-3)


@pytest.mark.parametrize("gravity", [1e-4, 1e-2, 1.6])
def test_nothing_falls_asleep_in_the_air(gripper_over_table, gravity):
    objects = (a_box("box", (0.05, 0.05, 0.05), (0.6, 0, 9.0), mass=0.1),)
    simulator = LiveSimulator(gripper_over_table, objects, ("box",), gravity=(0, 0, -gravity))
    simulator.hold(1.0)
    assert 9.0 - simulator.object_pose("box").translation[2] == pytest.approx(gravity / 2, rel=0.01)


def test_what_drifts_slowly_without_gravity_goes_on(gripper_over_table):
    objects = (a_box("box", (0.05, 0.05, 0.05), (0.6, 0, 0.5), mass=0.1),)
    simulator = LiveSimulator(gripper_over_table, objects, ("box",), gravity=(0, 0, 0))
    Injection(simulator).push({"box": np.array([1e-7, 0.0, 0.0])}, 0.1)  # 0.1 um/s
    before = simulator.object_pose("box").translation[0]
    simulator.hold(1.0)
    assert simulator.object_pose("box").translation[0] - before == pytest.approx(1e-7, rel=0.01)


def strike(simulator):
    """A motion of time that puts objects to sleep, wakes some of them and lets them rest again."""
    simulator.hold(0.35)
    Injection(simulator).push({"upper": np.array([0.3, 0.0, 0.0])}, 0.05)
    simulator.hold(0.6)
    return simulator.finish()


@pytest.mark.parametrize("rested", [0.3, 0.505, 1.0])
def test_a_snapshot_holds_what_is_asleep(gripper_over_table, rested):
    objects = a_stack()
    simulator = LiveSimulator(gripper_over_table, objects, [obj.name for obj in objects])
    simulator.hold(rested)
    state = simulator.snapshot()
    first = strike(simulator)
    simulator.move_object("board", SE3.from_xyz_rpy((0.6, 2.0, 0.06)))
    simulator.hold(0.3)
    simulator.restore(state)
    assert_equal_bits(first, strike(simulator))


def test_time_in_pieces_puts_the_same_to_sleep(gripper_over_table):
    objects = a_stack()
    runs = []
    for pieces in (1, 3, 97, 1000):
        simulator = LiveSimulator(gripper_over_table, objects, [obj.name for obj in objects])
        for part in np.array_split(np.arange(1000), pieces):
            simulator.hold_samples(len(part))
        runs.append(strike(simulator))
    for run in runs[1:]:
        assert_equal_bits(runs[0], run)


def test_mujoco_computes_no_contacts_of_what_is_asleep(gripper_over_table):
    """What the other tests are about; without it they would pass for nothing."""
    simulator = simulator_of(gripper_over_table, a_stack())
    physics = simulator.physics
    data = mujoco.MjData(physics.model)
    for _ in range(2000):
        mujoco.mj_step(physics.model, data)
    bodies = {
        physics.body_names[body] for body in physics.model.geom_bodyid[data.contact.geom].flat
    }
    assert not bodies & {"lower", "upper", "cylinder"}
