"""Belts and turntables carry what lies on them by friction alone."""

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.plugins.studio.live_simulator import LiveSimulator
from tests.simulation.physics_scenes import a_box

STILL = SurfaceMotion()
ALONG_X = SurfaceMotion((0.2, 0.0, 0.0))


def a_cell(robot, motion=STILL, friction=0.8, at=(0.4, 0.0)):
    """A belt of which the middle is at (0.4, 0), and a box on it."""
    belt = a_box("belt", (2.0, 0.6, 0.1), (0.4, 0, 1.0), surface_motion=motion)
    box = a_box("box", (0.05, 0.05, 0.05), (*at, 1.075), mass=0.3, friction=friction)
    return LiveSimulator(robot, (belt, box), ("belt", "box"))


def velocities(simulator, samples):
    poses = simulator.finish().object_poses["box"][-samples - 1 :, :3]
    return np.diff(poses, axis=0) / simulator.timestep


def test_a_box_moves_with_its_belt_and_stops_with_it(ur3e):
    simulator = a_cell(ur3e)
    simulator.hold(0.5)  # the box falls asleep
    simulator.drive_surface("belt", ALONG_X, 0.2)
    simulator.hold(0.3)
    assert velocities(simulator, 200) == pytest.approx(np.tile([0.2, 0, 0], (200, 1)), abs=1e-4)
    assert simulator.object_pose("box").translation[0] == pytest.approx(0.4 + 0.02 + 0.06, abs=1e-4)
    simulator.drive_surface("belt", STILL, 0.2)
    simulator.hold(0.3)
    assert np.abs(velocities(simulator, 200)).max() < 1e-5
    assert simulator.object_pose("belt").translation == pytest.approx([0.4, 0, 1.0])


@pytest.mark.parametrize("friction", [0.03, 0.05, 0.1])
def test_a_belt_that_jumps_to_its_speed_pulls_with_friction_alone(ur3e, friction):
    simulator = a_cell(ur3e, friction=friction)
    simulator.hold(0.2)
    simulator.drive_surface("belt", SurfaceMotion((1.0, 0, 0)), 0.0)
    simulator.hold(0.2)
    speed = velocities(simulator, 1)[-1, 0]
    assert speed == pytest.approx(friction * 9.8 * 0.2, rel=0.02)


def test_a_turntable_carries_a_box_about_its_middle(ur3e):
    turning = SurfaceMotion(rotation=1.0)
    simulator = a_cell(ur3e, turning, at=(0.6, 0.0))
    simulator.hold(0.3)
    start = simulator.object_pose("box")
    simulator.hold(0.5)
    table = simulator.object_pose("belt")
    expected = table @ turning.carried(table.inverse() @ start, 0.5)
    position, angle = expected.distance_to(simulator.object_pose("box"))
    assert (position, angle) == pytest.approx((0, 0), abs=1e-3)
    assert start.distance_to(simulator.object_pose("box"))[1] == pytest.approx(0.5, abs=2e-3)


def test_a_turned_belt_moves_things_in_its_own_axes(ur3e):
    belt = a_box("belt", (2.0, 0.6, 0.1), (0.4, 0, 1.0), surface_motion=ALONG_X)
    box = a_box("box", (0.05, 0.05, 0.05), (0.4, 0, 1.075), mass=0.3)
    simulator = LiveSimulator(ur3e, (belt, box), ("belt", "box"))
    simulator.move_object("belt", SE3.from_xyz_rpy((0.4, 0, 1.0), (0, 0, np.pi / 2)))
    simulator.hold(0.3)
    assert velocities(simulator, 1)[-1] == pytest.approx([0, 0.2, 0], abs=1e-3)


def test_a_restored_simulator_has_the_belts_of_its_snapshot(ur3e):
    simulator = a_cell(ur3e, ALONG_X)
    simulator.hold(0.1)
    state = simulator.snapshot()
    simulator.hold(0.2)
    first = simulator.finish().object_poses["box"].copy()
    simulator.restore(state)
    simulator.drive_surface("belt", STILL, 0.1)
    simulator.restore(state)
    assert simulator.surface_motion("belt") == ALONG_X
    simulator.hold(0.2)
    assert np.array_equal(simulator.finish().object_poses["box"], first)


@pytest.mark.parametrize("rotation", [0.0, 1e-9, 0.7, -2.0])
def test_the_predicted_pose_is_the_integral_of_the_velocity(rotation):
    motion = SurfaceMotion((0.3, -0.1, 0.0), rotation)
    pose, steps, duration = SE3.from_xyz_rpy((0.2, 0.5, 0.1), (0, 0, 0.4)), 20_000, 1.5
    point = pose.translation.copy()
    for _ in range(steps):
        middle = point + 0.5 * duration / steps * motion.velocity_at(point)
        point = point + duration / steps * motion.velocity_at(middle)
    carried = motion.carried(pose, duration)
    assert carried.translation == pytest.approx(point, abs=1e-7)
    assert pose.distance_to(carried)[1] == pytest.approx(abs(rotation) * duration, abs=1e-6)
