"""Objects appear, move and disappear in a running physics; what the record says of them."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.errors import StepFailed
from harness.core.geometry import Box, Friction, Shape
from harness.core.spatial import SE3
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.simulation.physics_scenes import a_box, a_cylinder, move_arm


def a_scene():
    return (
        a_box("Table", (1.5, 1.6, 0.03), (0.4, 0, 1.0)),
        a_box("red_box", (0.05, 0.05, 0.1), (0.36, 0, 1.065), mass=0.3),
        a_cylinder("later", 0.03, 0.1, (0.32, 0.2, 1.065), mass=0.1),
        a_box("shelf", (0.2, 0.2, 0.02), (0.5, 0.3, 1.2)),
        a_box("imagined", (0.2, 0.2, 0.2), (0.4, 0, 1.1), in_simulation=False),
    )


def test_a_parked_object_is_absent_until_it_is_added(ur3e):
    simulator = MujocoSimulator(ur3e, a_scene(), ("Table", "red_box"))
    simulator.hold(0.2)
    added = simulator.sample_count
    simulator.add_object("later", SE3.from_xyz_rpy((0.32, 0.2, 1.065)))
    simulator.hold(0.5)
    removed = simulator.sample_count
    simulator.remove_object("later")
    simulator.hold(0.1)
    signals = simulator.finish()
    poses = signals.object_poses["later"]
    assert np.isnan(poses[:added]).all()
    assert poses[added:removed, 2] == pytest.approx(1.065, abs=1e-4)
    assert np.isnan(poses[removed:]).all()
    weight = signals.contact_forces["Table", "later"]
    assert not weight[:added].any()
    assert weight[removed - 1] == pytest.approx(0.1 * 9.8, rel=1e-3)
    assert not weight[removed:].any()
    assert np.isfinite(signals.object_poses["red_box"]).all()
    assert "imagined" not in signals.object_poses


def test_a_static_object_can_be_moved_under_a_falling_one(ur3e):
    simulator = MujocoSimulator(ur3e, a_scene(), ("Table", "shelf"))
    simulator.hold(0.1)
    simulator.move_object("shelf", SE3.from_xyz_rpy((0.5, -0.3, 1.2)))
    simulator.add_object("later", SE3.from_xyz_rpy((0.5, -0.3, 1.3)))
    assert simulator.settle(0.01, timeout=3.0)
    assert simulator.object_pose("later").translation[2] == pytest.approx(1.26, abs=1e-3)
    shelf = simulator.finish().object_poses["shelf"][:, 1]
    assert shelf[0] == 0.3
    assert shelf[-1] == -0.3


def test_settling_gives_up_on_what_keeps_moving_and_names_it(ur3e):
    simulator = MujocoSimulator(ur3e, a_scene()[2:3], ("later",))
    with pytest.raises(
        StepFailed, match=r"later still moves with 1\.92 m/s after 0\.2 s"
    ) as caught:
        simulator.settle(0.01, timeout=0.2)  # it falls: there is no table
    assert caught.value.code == "TIMED_OUT"
    assert simulator.time == pytest.approx(0.2)


def test_what_has_settled_is_at_rest_for_the_expectations_too(ur3e):
    """A box that hits the table stands still for a moment before the judge's 50 ms are over."""
    simulator = MujocoSimulator(ur3e, a_scene(), ("Table",))
    simulator.add_object("later", SE3.from_xyz_rpy((0.32, 0.2, 1.3)))
    assert simulator.settle(1e-3, timeout=3.0)
    heights = simulator.finish().object_poses["later"][-51:, 2]
    assert float(np.ptp(heights)) < 0.05 * 1e-3


def test_a_run_is_bounded_in_simulated_time(ur3e):
    simulator = MujocoSimulator(ur3e, (), ())
    with pytest.raises(StepFailed, match="it may take 600 s of simulated time") as caught:
        simulator.hold(1e9)
    assert caught.value.code == "TIMED_OUT"
    assert simulator.sample_count == 1


def test_a_run_is_bounded_in_memory(ur3e):
    boxes = [a_box(f"box{i}", (0.02, 0.02, 0.02), (i, 0, 0.01), mass=0.01) for i in range(150)]
    simulator = MujocoSimulator(ur3e, boxes, (), gravity=(0, 0, 0))
    with pytest.raises(StepFailed, match="MiB are the limit: use fewer objects"):
        simulator.hold(590.0)
    assert simulator.sample_count == 1


def test_every_signal_has_a_row_for_every_sample_from_time_zero(ur3e):
    simulator = MujocoSimulator(ur3e, a_scene(), ("Table", "red_box"), frames=("tool0",))
    assert simulator.sample_count == 1
    assert simulator.time == 0.0
    np.testing.assert_array_equal(simulator.joint_positions(), ur3e.start_positions())
    move_arm(simulator, (0, -1.4, 0.2, -1.57, 0, 0), duration=0.5)
    signals = simulator.finish()
    count = simulator.sample_count
    assert count == 501
    np.testing.assert_allclose(signals.times, 0.001 * np.arange(count))
    joints = (count, len(ur3e.joint_names))
    for name in ("positions", "velocities", "efforts", "commands", "command_velocities"):
        assert getattr(signals, f"joint_{name}").shape == joints
    rows = (*signals.frames.values(), *signals.object_poses.values(), signals.tcp_pose)
    assert {row.shape for row in rows} == {(count, 7)}
    assert {force.shape for force in signals.contact_forces.values()} == {(count,)}
    assert set(signals.object_poses) == {"Table", "red_box", "later", "shelf"}
    np.testing.assert_array_equal(signals.joint_positions[0], ur3e.start_positions())


def test_a_dropped_box_is_named_with_what_it_falls_on(ur3e):
    simulator = MujocoSimulator(ur3e, a_scene(), ("Table", "red_box"))
    simulator.hold(0.5)
    forces = simulator.finish().contact_forces
    assert list(forces) == [("Table", "red_box")]
    assert forces["Table", "red_box"][-1] == pytest.approx(0.3 * 9.8, rel=1e-3)


def test_a_shape_may_be_more_slippery_than_its_object(ur3e):
    floor = a_box("floor", (4, 4, 0.1), (0, 0, -0.05))
    rough = a_box("rough", (0.1, 0.1, 0.1), (1, 0.5, 0.05), mass=0.5)
    sole = Shape(Box((0.1, 0.1, 0.1)), friction=Friction(0.05))
    soled = replace(a_box("soled", (0.1, 0.1, 0.1), (1, -0.5, 0.05), mass=0.5), shapes=(sole,))
    downhill = (2.0, 0.0, -9.8)  # an angle of friction of 0.2
    simulator = MujocoSimulator(
        ur3e, (floor, rough, soled), ("floor", "rough", "soled"), gravity=downhill
    )
    simulator.hold(0.5)
    assert simulator.object_pose("rough").translation[0] == pytest.approx(1.0, abs=1e-3)
    slid = 0.5 * (2.0 - 0.05 * 9.8) * 0.5**2
    assert simulator.object_pose("soled").translation[0] == pytest.approx(1.0 + slid, rel=0.02)
