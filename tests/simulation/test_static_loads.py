"""Contact forces of loads at rest, and the impulse of a fall, against theory."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.simulation.physics_scenes import a_box, a_cylinder

G = 9.8
ONE_PER_CENT = 0.01


def recorded(description, objects, seconds):
    simulator = MujocoSimulator(description, objects, [obj.name for obj in objects])
    simulator.hold(seconds)
    return simulator.finish()


@pytest.mark.parametrize("mass", [0.02, 2.0, 50.0])
@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_a_support_carries_the_weight(gripper_over_table, shape, mass):
    floor = a_box("floor", (2, 2, 0.1), (1, 0, -0.05))
    thing = (
        a_box("thing", (0.1, 0.1, 0.1), (1, 0, 0.05), mass=mass)
        if shape == "box"
        else a_cylinder("thing", 0.05, 0.1, (1, 0, 0.05), mass=mass)
    )
    signals = recorded(gripper_over_table, (floor, thing), 1.0)
    force = signals.contact_forces["floor", "thing"][-200:]
    assert force == pytest.approx(mass * G, rel=ONE_PER_CENT)
    assert 0.05 - signals.object_poses["thing"][-1, 2] < 1e-4, "it sinks in by less than 0.1 mm"


@pytest.mark.parametrize("degrees", [5, 20, 30])
def test_a_slope_carries_the_part_of_the_weight_across_it(gripper_over_table, degrees):
    """Friction holds it: the tangent of 30 degrees is 0.58."""
    turned = SE3.from_xyz_rpy((0.6, 0, 0.3), (0, np.radians(degrees), 0))
    board = replace(a_box("board", (0.6, 0.6, 0.02), (0, 0, 0), friction=0.7), pose=turned)
    box = a_box("box", (0.1, 0.1, 0.1), (0, 0, 0), mass=1.0, friction=0.7)
    box = replace(box, pose=turned @ SE3.from_xyz_rpy((0, 0, 0.06)))
    signals = recorded(gripper_over_table, (board, box), 1.5)
    force = signals.contact_forces["board", "box"][-200:]
    assert force == pytest.approx(G * np.cos(np.radians(degrees)), rel=ONE_PER_CENT)
    way = signals.object_poses["box"][-1, :3] - signals.object_poses["box"][500, :3]
    assert np.linalg.norm(way) < 3e-5, "it does not creep by more than 0.03 mm in a second"


@pytest.mark.parametrize("offset", [0.0, 0.02, 0.06])
def test_two_posts_share_a_load_by_the_law_of_the_lever(gripper_over_table, offset):
    posts = tuple(
        a_box(name, (0.02, 0.1, 0.1), (x, 0, 0.05)) for name, x in (("near", 0.5), ("far", 0.7))
    )
    plank = a_box("plank", (0.5, 0.05, 0.02), (0.6 + offset, 0, 0.11), mass=1.0)
    forces = recorded(gripper_over_table, (*posts, plank), 1.0).contact_forces
    total = sum(forces[pair][-1] for pair in (("near", "plank"), ("far", "plank")))
    assert total == pytest.approx(G, rel=ONE_PER_CENT)
    # The posts are 2 cm wide: where on them the load rests is between their edges.
    least, most = (0.5 * G * (1 + offset / arm) for arm in (0.11, 0.09))
    assert least * 0.99 <= forces["far", "plank"][-1] <= most * 1.01


@pytest.mark.parametrize("height", [0.02, 0.2])
def test_a_fall_ends_with_the_impulse_of_its_momentum(gripper_over_table, height):
    floor = a_box("floor", (2, 2, 0.1), (1, 0, -0.05))
    box = a_box("box", (0.1, 0.1, 0.1), (1, 0, 0.05 + height), mass=0.5)
    signals = recorded(gripper_over_table, (floor, box), 1.0)
    force = signals.contact_forces["box", "floor"]
    first = int(np.argmax(force > 0))
    window = slice(first, first + 200)
    impulse = force[window].sum() * 1e-3 - 0.5 * G * 0.2
    assert impulse == pytest.approx(0.5 * np.sqrt(2 * G * height), rel=ONE_PER_CENT)
    rise = signals.object_poses["box"][first:, 2].max() - 0.05
    assert rise < 1e-3, "it does not bounce"
