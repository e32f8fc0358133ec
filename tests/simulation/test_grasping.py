"""Grasps are by friction alone: they hold when they should and slip when they must."""

import mujoco
import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.simulation.physics_scenes import ABOVE, AT_CYLINDER, a_box, a_cylinder, move_arm

GRIP = 2.0


def squeeze(description, *, effort=GRIP, friction=30.0, mass=0.1, position=0.59):
    """Close on a cylinder 2 mm off-centre that stands on a stand, take the stand away, wait 4 s."""
    cylinder = a_cylinder("cylinder", 0.03, 0.1, (0, 0.002, 0.12), mass=mass, friction=friction)
    stand = a_box("stand", (0.5, 0.5, 0.02), (0, 0, 0.06), friction=0.6)
    simulator = MujocoSimulator(description, (cylinder, stand), ("cylinder", "stand"))
    result = simulator.command_gripper(position, effort, timeout=5.0)
    held = simulator.object_pose("cylinder")
    simulator.remove_object("stand")
    simulator.hold(4.0)
    fallen = held.translation[2] - simulator.object_pose("cylinder").translation[2]
    return simulator, result, fallen


def test_fingers_stall_on_a_60_mm_cylinder_and_hold_it(gripper_over_table):
    simulator, result, fallen = squeeze(gripper_over_table)
    assert result.stalled
    assert not result.reached_goal
    assert result.position == pytest.approx(0.576, abs=0.003)
    assert abs(result.effort) == pytest.approx(GRIP, abs=0.1)
    assert result.contacts == {"right": ("cylinder",), "left": ("cylinder",)}
    assert abs(fallen) < 0.0005
    forces = simulator.finish().contact_forces
    right, left = (forces[f"rh_p12_rn_{side}2", "cylinder"][-1] for side in "rl")
    assert right == pytest.approx(left, rel=0.02)
    assert right == pytest.approx(19.7, rel=0.05)  # GRIP through the lever of 50.8 mm, halved


@pytest.mark.parametrize(
    "options", [{"friction": 0.01}, {"effort": 0.02 * GRIP}], ids=["slippery", "weak"]
)
def test_a_grip_without_enough_friction_lets_go(gripper_over_table, options):
    _, _, fallen = squeeze(gripper_over_table, **options)
    assert fallen > 1.0


def test_a_gripper_that_meets_nothing_reaches_its_goal(gripper_over_table):
    simulator = MujocoSimulator(gripper_over_table, (), ())
    closed = simulator.command_gripper(1.0, GRIP, timeout=5.0)
    assert closed.reached_goal
    assert not closed.stalled
    assert closed.contacts == {"right": (), "left": ()}
    assert simulator.command_gripper(0.0, GRIP, timeout=5.0).reached_goal
    simulator.hold(0.2)
    mimics = simulator.joint_positions()
    np.testing.assert_allclose(mimics, gripper_over_table.with_mimics(mimics), atol=2e-5)
    speed = np.abs(simulator.finish().joint_velocities).max()
    assert speed < gripper_over_table.joint_by_name["rh_r1_joint"].velocity


def test_the_smaller_friction_of_a_pair_counts(gripper_over_table):
    cylinder = a_cylinder("cylinder", 0.03, 0.1, (0, 0, 0.119), mass=0.1, friction=0.01)
    stand = a_box("stand", (0.5, 0.5, 0.02), (0, 0, 0.06), friction=0.6)
    rough = a_box("rough", (0.1, 0.1, 0.1), (0.2, 0, 0.119), mass=1.0, friction=30.0)
    simulator = MujocoSimulator(
        gripper_over_table, (cylinder, stand, rough), ("cylinder", "stand", "rough")
    )
    model, data = simulator.physics.model, mujoco.MjData(simulator.physics.model)
    mujoco.mj_forward(model, data)
    sliding = {}
    for contact in data.contact:
        bodies = {model.body(model.geom_bodyid[geom]).name for geom in contact.geom}
        sliding[frozenset(bodies)] = contact.friction[0]
    assert sliding[frozenset(("cylinder", "stand"))] == 0.01
    assert sliding[frozenset(("rough", "stand"))] == 0.6


def test_a_ur3e_lifts_the_lessons_cylinder(ur3e):
    table = a_box("Table", (1.5, 1.6, 0.03), (0.4, 0, 1.0), friction=0.6)
    cylinder = a_cylinder("cylinder", 0.03, 0.1, (0.32, -0.168, 1.065), mass=0.1, friction=30.0)
    simulator = MujocoSimulator(ur3e, (table, cylinder), ("Table", "cylinder"))
    move_arm(simulator, ABOVE)
    move_arm(simulator, AT_CYLINDER)
    assert simulator.command_gripper(0.59, GRIP, timeout=5.0).stalled
    grasped = simulator.sample_count - 1
    move_arm(simulator, ABOVE)
    simulator.hold(1.0)
    signals = simulator.finish()
    lift = signals.object_poses["cylinder"][-1, 2] - signals.object_poses["cylinder"][0, 2]
    assert lift == pytest.approx(0.22, abs=0.002)
    in_hand = [
        SE3.from_vector(signals.tcp_pose[i]).inverse()
        @ SE3.from_vector(signals.object_poses["cylinder"][i])
        for i in (grasped, -1)
    ]
    drift, turn = in_hand[0].distance_to(in_hand[1])
    assert drift < 0.001
    assert turn < 0.01
    assert signals.contact_forces["Table", "cylinder"][-1] == 0.0
    errors = np.abs(signals.joint_positions - signals.joint_commands)[grasped:, :6]
    assert errors.max() < 0.002  # an unknown payload sags less than a millimetre at 0.4 m


def test_what_is_held_does_not_creep_while_the_hand_swings(ur3e):
    table = a_box("Table", (1.5, 1.6, 0.03), (0.4, 0, 1.0), friction=0.6)
    cylinder = a_cylinder("cylinder", 0.03, 0.1, (0.32, -0.168, 1.065), mass=0.1, friction=30.0)
    simulator = MujocoSimulator(ur3e, (table, cylinder), ("Table", "cylinder"))
    move_arm(simulator, ABOVE)
    move_arm(simulator, AT_CYLINDER)
    simulator.command_gripper(0.59, GRIP, timeout=5.0)
    grasped = simulator.sample_count - 1
    move_arm(simulator, ABOVE)
    move_arm(simulator, (0.0, -1.5707, 0.0, -1.5707, 0.0, 0.0))
    signals = simulator.finish()
    first, last = (
        SE3.from_vector(signals.tcp_pose[i]).inverse()
        @ SE3.from_vector(signals.object_poses["cylinder"][i])
        for i in (grasped, -1)
    )
    assert first.distance_to(last)[0] < 0.001  # 1.25 mm without a friction damping of its own


@pytest.mark.parametrize(("effort", "lifted"), [(10.0, True), (0.2, False)])
def test_an_open_manipulator_lifts_the_red_box_only_if_it_presses(open_manipulator, effort, lifted):
    box = a_box("red_box", (0.05, 0.05, 0.1), (0.36, 0, 0.05), mass=0.1, friction=30.0)
    floor = a_box("floor", (2, 2, 0.02), (0.8, 0, -0.01))
    simulator = MujocoSimulator(open_manipulator, (box, floor), ("red_box", "floor"))
    assert simulator.command_gripper(0.019, 10.0, timeout=5.0).reached_goal
    move_arm(simulator, (0.0, 0.333649, 0.844868, -1.178517))
    move_arm(simulator, (0.0, 0.87, -0.195, -0.67))
    result = simulator.command_gripper(-0.01, effort, timeout=5.0)
    assert result.contacts == {"left": ("red_box",), "right": ("red_box",)}
    move_arm(simulator, (0.0, 0.0, 0.0, 0.0))
    simulator.hold(2.0)
    height = simulator.object_pose("red_box").translation[2]
    assert bool(height > 0.15) is lifted


def test_a_weld_carries_what_friction_would_not(ur3e):
    table = a_box("Table", (1.5, 1.6, 0.03), (0.4, 0, 1.0))
    cylinder = a_cylinder("cylinder", 0.03, 0.1, (0.32, -0.168, 1.065), mass=0.1, friction=0.01)
    simulator = MujocoSimulator(ur3e, (table, cylinder), ("Table", "cylinder"))
    move_arm(simulator, ABOVE)
    move_arm(simulator, AT_CYLINDER)
    start = simulator.object_pose("cylinder").translation[2]
    simulator.weld("cylinder", "rh_p12_rn_base")
    move_arm(simulator, ABOVE)
    held = simulator.object_pose("cylinder").translation[2]
    assert held - start == pytest.approx(0.22, abs=0.001)
    simulator.unweld("cylinder")
    simulator.hold(1.0)
    assert simulator.object_pose("cylinder").translation[2] < start + 0.05


def test_the_fingers_press_a_grasped_object_against_each_other(gripper_over_table):
    cylinder = a_cylinder("cylinder", 0.03, 0.1, (0, 0, 0.119), mass=0.1)
    stand = a_box("stand", (0.5, 0.5, 0.02), (0, 0, 0.06))
    simulator = MujocoSimulator(gripper_over_table, (cylinder, stand), ("cylinder", "stand"))
    simulator.command_gripper(0.62, GRIP, timeout=5.0)
    simulator.hold(0.2)
    signals = simulator.finish()
    pressing = {
        pair: rows[:, 3:] for pair, rows in signals.presses.items() if pair[1] == "cylinder"
    }
    sides = gripper_over_table.gripper.sides
    totals = [
        sum(force[-1] for (link, _), force in pressing.items() if link in links)
        for links in sides.values()
    ]
    for links, total in zip(sides.values(), totals, strict=True):
        scalar = sum(
            force[-1]
            for (link, name), force in signals.contact_forces.items()
            if link in links and name == "cylinder"
        )
        assert 0.9 * scalar < np.linalg.norm(total) <= scalar * (1 + 1e-6)
    directions = [total / np.linalg.norm(total) for total in totals]
    assert directions[0] @ directions[1] < -0.9


@pytest.mark.nightly
def test_presses_say_where_fingers_touch_what_they_hold_and_which_way(gripper_over_table):
    simulator, _, _ = squeeze(gripper_over_table)
    signals = simulator.finish()
    centre = signals.object_poses["cylinder"][-1, :2]
    pads = [("rh_p12_rn_r2", "cylinder"), ("rh_p12_rn_l2", "cylinder")]
    for pair in pads:
        place, force = signals.presses[pair][-1, :3], signals.presses[pair][-1, 3:]
        outward = place[:2] - centre
        assert np.linalg.norm(outward) == pytest.approx(0.03, abs=0.001), "on the cylinder's side"
        assert force[:2] @ outward < -0.9 * np.linalg.norm(force) * np.linalg.norm(outward)
        assert np.isnan(signals.presses[pair][0]).all(), "not yet"
    assert all(link in gripper_over_table.link_names for link, _ in signals.presses)


@pytest.mark.nightly
@pytest.mark.parametrize("mass", [0.3, 1.0])
def test_friction_holds_up_to_coulombs_limit_and_slips_above_it(gripper_over_table, mass):
    """Friction at 0.81, 0.9 and 0.996 of mu times the sum of both fingers' forces; then above.

    The forces are measured while the fingers hold with little more friction than they need.
    """
    friction, weight = 30.0, 9.8 * mass
    for _ in range(2):
        simulator, _, fallen = squeeze(gripper_over_table, mass=mass, friction=friction)
        assert fallen < 1e-3
        forces = simulator.finish().contact_forces
        pressed = sum(forces[f"rh_p12_rn_{side}2", "cylinder"][-1] for side in "rl")
        friction = weight / (0.95 * pressed)

    def sinks(share):
        return squeeze(gripper_over_table, mass=mass, friction=weight / (share * pressed))[2]

    assert max(sinks(share) for share in (0.81, 0.9, 0.996)) < 2e-4  # in 4 s
    assert min(sinks(share) for share in (1.004, 1.05)) > 1.0
