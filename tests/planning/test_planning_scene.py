"""The planning scene: what is checked against what, and at which distance."""

import numpy as np
import pytest

from harness.core.errors import PlanningFailed, StepFailed
from harness.core.geometry import Box, Capsule, Cylinder, Shape, Sphere
from harness.language.scenario import RobotSpec
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.assembly.several_arms import joined_arms
from harness.ports.goals import PoseGoal
from harness.robot.load import load_robot
from tests.planning.lesson import ARM, TCP, Cell, at, thing, ur


@pytest.fixture
def cell():
    return Cell(ur("ur3e"))


def pairs(touches):
    return [{touch.first, touch.second} for touch in touches]


def test_the_base_and_its_table_are_no_finding(cell):
    assert cell.scene.touches(cell.with_arm(cell.named("up")), 0.02) == ()


def test_an_object_at_the_gripper_touches_it_with_its_depth(cell):
    tcp = cell.kinematics.link_pose(cell.state, TCP)
    cell.add(thing("ball", tcp, Shape(Sphere(0.2))))
    touches = cell.scene.touches(cell.state)
    assert {"rh_p12_rn_base", "ball"} in pairs(touches)
    assert touches[0].distance < -0.1
    assert [t.distance for t in touches] == sorted(t.distance for t in touches)


def test_touches_are_the_pairs_whose_distance_is_too_small(cell):
    for index, x in enumerate((-0.5, 0.3, 0.6)):
        cell.add(thing(f"post {index}", at(x, 0.3, 1.2), Shape(Box((0.05, 0.2, 0.4)))))
    rng, found = np.random.default_rng(4), 0
    for padding in (0.0, 0.05) * 30:
        state = cell.with_arm(rng.uniform(-np.pi, np.pi, 6))
        near = {
            (touch.first, touch.second, required): touch.distance
            for touch, keeps_padding in cell.scene.distances(state)
            if touch.distance <= (required := padding if keeps_padding else 0.0)
        }
        touches = cell.scene.touches(state, padding)
        measured = {(t.first, t.second, t.required): t.distance for t in touches}
        assert measured == pytest.approx(near, abs=1e-5)  # Coal's depths vary a little
        assert list(measured.values()) == sorted(measured.values())
        found += len(near)
    assert found > 60


@pytest.mark.parametrize("shape", [Box((0.1, 0.1, 0.1)), Cylinder(0.05, 0.1)])
def test_padding_is_kept_from_objects_but_not_between_links(cell, shape):
    palm = cell.kinematics.link_pose(cell.state, TCP).translation
    # above the upright arm, 30 mm over the highest point of what it carries
    gap = 0.03
    high = thing("shelf", at(palm[0], palm[1], palm[2] + 2.0), Shape(shape))
    cell.add(high)
    top = 2.0 - min(t.distance for t, _ in cell.scene.distances(cell.state) if t.second == "shelf")
    cell.scene.move_object("shelf", at(palm[0], palm[1], palm[2] + top + gap))
    assert cell.scene.touches(cell.state, gap - 0.002) == ()
    assert all("shelf" in pair for pair in pairs(cell.scene.touches(cell.state, gap + 0.002)))
    assert cell.scene.touches(cell.state, gap + 0.002)


@pytest.mark.parametrize("holder", ["", "left", "right"])
def test_padding_is_kept_between_two_arms_and_what_they_hold(holder):
    bases = {"left": {"xyz": [0, 0.2, 0]}, "right": {"xyz": [0, -0.2, 0]}}
    small = {"model": "open_manipulator_x"}
    robot = joined_arms(
        {arm: load_robot(RobotSpec.model_validate({**small, "base": bases[arm]})) for arm in bases}
    )
    scene, state = CoalScene(robot), robot.start_positions()
    for x, name in enumerate(("rod", "post")):
        scene.add_object(thing(name, at(0.3 + x, 0, 0.3), Shape(Box((0.1, 0.1, 0.1)))), at(0, 0, 2))
    carried = dict(robot.arm_of_link)
    if holder:
        link = robot.of_arm[holder].tcp_link
        scene.attach_object("rod", link, (), state)
        carried["rod"] = holder
    found = [({t.first, t.second}, keeps) for t, keeps in scene.distances(state)]
    owners = [({carried.get(name, name) for name in pair}, keeps) for pair, keeps in found]
    assert {"left", "right"} in [owner for owner, keeps in owners if keeps]
    assert all(keeps == (len(owner) == 2) for owner, keeps in owners)


def test_a_capsule_is_round_at_its_ends(cell):
    cell.add(thing("pill", at(0, 0, 3), Shape(Capsule(0.1, 0.4))))
    cell.add(thing("can", at(0, 1, 3), Shape(Cylinder(0.1, 0.4))))
    lowest = {}
    for name in ("pill", "can"):
        cell.scene.move_object(name, at(0.0, 0.0, 3.0))
        found = [t.distance for t, _ in cell.scene.distances(cell.state) if t.second == name]
        lowest[name] = min(found)
        cell.scene.move_object(name, at(5.0, 0.0, 3.0))
    assert lowest["pill"] == pytest.approx(lowest["can"] - 0.1, abs=0.03)


def test_an_attached_object_moves_with_its_link_and_stays_where_it_is_detached(cell):
    cylinder = thing("cylinder", at(0.3, 0, 1.4), Shape(Cylinder(0.03, 0.1)))
    cell.add(cylinder)
    in_link = cell.scene.attach_object("cylinder", TCP, (), cell.state)
    moved = cell.with_arm(cell.named("mogi_home"))
    expected = cell.kinematics.link_pose(moved, TCP) @ in_link
    assert cell.scene.object_pose("cylinder", moved).distance_to(expected)[0] < 1e-12
    assert dict(cell.scene.attached()) == {"cylinder": TCP}
    released = cell.scene.detach_object("cylinder", moved)
    assert released.distance_to(expected)[0] < 1e-12
    assert cell.scene.object_pose("cylinder", cell.state).distance_to(expected)[0] < 1e-12


def test_a_held_object_may_touch_the_gripper_but_not_the_arm(cell):
    tcp = cell.kinematics.link_pose(cell.state, TCP)
    cell.add(thing("stick", tcp, Shape(Box((0.04, 0.04, 0.04)))))
    cell.add(thing("beam", tcp, Shape(Box((0.9, 0.9, 0.02)))))
    touching = cell.description.gripper.links
    cell.scene.attach_object("stick", TCP, touching, cell.state)
    assert not any(
        "stick" in pair for pair in pairs(cell.scene.touches(cell.state)) if "beam" not in pair
    )
    cell.scene.attach_object("beam", TCP, touching, cell.state)
    folded = cell.with_arm([0, -1.57, 2.6, -1.0, 1.57, 0])
    assert any("beam" in pair and "Table" not in pair for pair in pairs(cell.scene.touches(folded)))


def test_allowed_pairs_are_let_through_until_they_are_not(cell):
    tcp = cell.kinematics.link_pose(cell.state, TCP)
    cell.add(thing("ball", tcp, Shape(Sphere(0.1))))
    cell.scene.set_allowed([("robot", "ball")], allowed=True)
    assert cell.scene.touches(cell.state) == ()
    cell.scene.set_allowed([("robot", "ball")], allowed=False)
    assert cell.scene.touches(cell.state)


def test_an_unknown_object_is_named_with_those_there_are(cell):
    with pytest.raises(StepFailed) as caught:
        cell.scene.remove_object("tabel")
    assert caught.value.code == "INVALID_OBJECT_NAME"
    assert "Table_0" in caught.value.message


def checker_of(cell, padding=0.0):
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    return MotionChecker(cell.scene, space, space.part(cell.state), padding)


@pytest.mark.parametrize(
    ("gap", "margin", "drops"),
    [
        (0.001, 0.0005, {-0.05: True, 0.0003: True, 0.0015: False}),
        (0.0003, 0.0, {-0.05: True, 0.0002: True, 0.0004: False}),  # free, so it stays free
        (0.00005, -0.00045, {-0.05: True, 0.0004: True, 0.0006: False}),  # it stands on it
    ],
)
def test_a_pair_too_near_at_the_start_may_come_no_nearer(cell, gap, margin, drops):
    """A box just under a held cylinder: up is free, half a millimetre down is the most."""
    cell.state = cell.with_arm([-0.858, -1.323, 1.764, -2.011, -1.571, -1.643])
    tcp = cell.kinematics.link_pose(cell.state, TCP)
    below = tcp.translation[2]
    x, y = tcp.translation[:2]
    cell.add(thing("cylinder", at(x, y, below), Shape(Cylinder(0.03, 0.1))))
    cell.scene.attach_object("cylinder", TCP, cell.description.gripper.links, cell.state)
    cell.add(thing("support", at(x, y, below - 0.05 - gap - 0.01), Shape(Box((0.2, 0.2, 0.02)))))
    checker = checker_of(cell, padding=0.005)
    lowered = [entry for entry in checker.lowered if entry.pair == ("cylinder", "support")]
    assert lowered[0].start_distance == pytest.approx(gap, abs=1e-6)
    assert lowered[0].margin == pytest.approx(margin, abs=1e-6)
    assert checker.state_free(checker.space.part(cell.state))
    for drop, is_free in drops.items():
        lower = cell.kinematics.link_pose(cell.state, TCP)
        moved = at(0, 0, -drop) @ lower
        near = cell.kinematics.solve(ARM, PoseGoal(TCP, moved), cell.state, 0)[0]
        assert checker.state_free(near) is is_free


def test_a_start_deep_in_an_object_is_refused_with_pair_and_depth(cell):
    tcp = cell.kinematics.link_pose(cell.state, TCP)
    cell.add(thing("ball", tcp, Shape(Sphere(0.1))))
    with pytest.raises(PlanningFailed) as caught:
        checker_of(cell)
    assert caught.value.code == "START_STATE_IN_COLLISION"
    assert caught.value.facts["touches"][0]["distance"] < -0.002
    assert "ball" in caught.value.facts["touches"][0]["pair"]


def test_free_states_are_those_without_touches(cell):
    checker = checker_of(cell, padding=0.01)
    rng = np.random.default_rng(2)
    space = checker.space
    for _ in range(100):
        positions = rng.uniform(np.maximum(space.lower, -3), np.minimum(space.upper, 3))
        assert checker.state_free(positions) == (not checker.touches(positions))
