"""Servos follow set points under effort limits, and say so when they cannot."""

import numpy as np
import pytest

from harness.core.errors import SimulationDiverged, StepFailed
from harness.core.trajectory import JointTrajectory
from harness.simulation.mujoco_simulator import MujocoSimulator
from harness.simulation.set_points import ramp, sample_trajectory
from tests.simulation.physics_scenes import ABOVE, AT_CYLINDER, a_box, a_motion, move_arm


def test_a_free_arm_stays_within_a_tenth_of_a_milliradian_of_its_set_points(ur3e):
    simulator = MujocoSimulator(ur3e, (), ())
    move_arm(simulator, ABOVE)
    move_arm(simulator, AT_CYLINDER, duration=1.0)
    signals = simulator.finish()
    error = np.abs(signals.joint_positions - signals.joint_commands)[:, :6].max()
    assert error < 1e-4
    limits = np.array([joint.effort for joint in ur3e.movable_joints])
    assert (np.abs(signals.joint_efforts) <= limits).all()
    assert np.isnan(signals.joint_commands[:, 7:]).all()  # mimic joints are not commanded


def test_recorded_efforts_do_not_jump_where_the_loop_is_looked_at(ur3e):
    simulator = MujocoSimulator(ur3e, (), ())
    move_arm(simulator, ABOVE, duration=1.0)
    efforts = simulator.finish().joint_efforts[:-1, :6]  # at the end the command stands still
    jumps = np.abs(np.diff(efforts, axis=0)).max(axis=0)
    assert (jumps < 0.05 * np.array([joint.effort for joint in ur3e.movable_joints])[:6]).all()


def test_the_tcp_is_recorded_where_the_joints_put_it(ur3e):
    simulator = MujocoSimulator(ur3e, (), (), frames=("tool0",))
    move_arm(simulator, AT_CYLINDER)
    signals = simulator.finish()
    np.testing.assert_allclose(signals.tcp_pose[-1, :3], [0.32, -0.17, 1.10], atol=1e-4)
    tool = signals.frames["tool0"][-1, :3]
    np.testing.assert_allclose(tool, [0.32, -0.17, 1.225], atol=1e-4)  # TCP 0.125 m below


def test_an_arm_that_meets_an_unexpected_wall_gives_up_and_names_it(ur3e):
    wall = a_box("wall", (0.4, 0.02, 1.0), (0.3, -0.25, 1.3))
    simulator = MujocoSimulator(ur3e, (wall,), ("wall",))
    move_arm(simulator, (0.0, -0.6, 0.6, -1.57, -1.57, 0.0))
    with pytest.raises(StepFailed) as caught:
        move_arm(simulator, (-1.5, -0.6, 0.6, -1.57, -1.57, 0.0))
    assert caught.value.code == "CONTROL_FAILED"
    facts = caught.value.facts
    assert facts["joint"] == "shoulder_pan_joint"
    assert facts["error"] > facts["tolerance"] == 0.2
    assert facts["contacts"][0]["bodies"][1] == "wall"
    assert facts["contacts"][0]["force"] > 20.0
    assert "presses on wall" in str(caught.value)
    commanded = simulator.commanded_positions()
    simulator.hold(0.5)
    assert np.abs(simulator.joint_positions() - commanded).max() < 0.02  # holds where it was
    signals = simulator.finish()
    touching = [pair for pair, force in signals.contact_forces.items() if force.max() > 20.0]
    assert touching
    assert all(second == "wall" for _, second in touching)


def test_a_goal_that_cannot_be_reached_in_time_fails_after_the_goal_time(ur3e):
    wall = a_box("wall", (0.4, 0.02, 1.0), (0.3, -0.25, 1.3))
    simulator = MujocoSimulator(ur3e, (wall,), ("wall",))
    move_arm(simulator, (0.0, -0.6, 0.6, -1.57, -1.57, 0.0))
    nudge = 0.02

    def push_on() -> None:
        for step in range(1, 60):
            move_arm(simulator, (-nudge * step, -0.6, 0.6, -1.57, -1.57, 0.0), duration=0.2)

    with pytest.raises(StepFailed, match="from its goal") as caught:
        push_on()
    assert caught.value.facts["tolerance"] == 0.01
    assert simulator.time - caught.value.facts["time"] == pytest.approx(0.2, abs=0.02)


def test_set_points_follow_the_cubic_through_two_points():
    trajectory = JointTrajectory(
        ("a",), np.array([0.0, 1.0]), np.array([[0.0], [2.0]]), np.zeros((2, 1)), np.zeros((2, 1))
    )
    points = sample_trajectory(trajectory, 0.002)
    assert len(points) == 501
    assert points.positions[250, 0] == pytest.approx(1.0)
    assert points.velocities[250, 0] == pytest.approx(3.0)  # 1.5 times the mean
    slope = np.gradient(points.positions[:, 0], 0.002)
    np.testing.assert_allclose(slope[1:-1], points.velocities[1:-1, 0], atol=1e-4)


def test_a_ramp_keeps_its_limits_and_arrives():
    for goal in (0.5, 0.01, -0.3, 0.0):
        points = ramp(0.0, goal, 0.66, 5.0, 0.002)
        assert points.positions[-1, 0] == pytest.approx(goal, abs=1e-12)
        assert points.velocities[-1, 0] == pytest.approx(0.0, abs=1e-9)
        assert np.abs(points.velocities).max() <= 0.66 + 1e-12


def test_numbers_that_are_not_finite_end_the_run(ur3e):
    simulator = MujocoSimulator(ur3e, (), ())
    motion = a_motion(ur3e, simulator.commanded_positions()[:6], np.full(6, np.nan), 0.1)
    with pytest.raises(SimulationDiverged, match="finite"):
        simulator.track(motion)
