"""Bounds of path constraints on both of their sides, on a robot that slides and turns."""

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.motions.held_constraints import PathBands
from harness.ports.goals import JointBand, OrientationBand, PathConstraints, PositionBox
from harness.robot.load import load_robot
from tests.planning.lesson import at, thing

INERTIA = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
JOINTS = (
    ("one", "prismatic", "1 0 0"),
    ("two", "prismatic", "0 1 0"),
    ("turn", "revolute", "0 0 1"),
    ("bend", "revolute", "0 1 0"),
)


def _urdf():
    parts, parent = ['<link name="base"/>'], "base"
    for name, kind, axis in JOINTS:
        parts.append(
            f'<link name="{name}_link"><inertial>{INERTIA}</inertial></link>'
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{name}_link"/><axis xyz="{axis}"/>'
            '<limit lower="-1.5" upper="1.5" velocity="1" effort="1"/></joint>'
        )
        parent = f"{name}_link"
    return (
        f'<robot name="slider">{"".join(parts)}<link name="tool"/><joint name="tip" type="fixed">'
        f'<parent link="{parent}"/><child link="tool"/><origin xyz="0 0 0.3"/></joint></robot>'
    )


GROUP = '<group name="arm"><chain base_link="base" tip_link="tool"/></group>'
SRDF = f'<robot name="slider">{GROUP}</robot>'


@pytest.fixture(scope="module")
def description(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slider")
    (folder / "slider.urdf").write_text(_urdf())
    (folder / "slider.srdf").write_text(SRDF)
    return load_robot(RobotSpec(urdf="slider.urdf", srdf="slider.srdf"), folder)


@pytest.fixture
def scene(description):
    return CoalScene(description)


@pytest.fixture
def held(scene):
    """Path constraints in the scene, of the group."""
    space = GroupSpace(scene.robot, "arm", np.zeros(4))

    def made(**constraints):
        return PathBands(PathConstraints(**constraints), space, scene.frame)

    return made


BOX = {
    "position": PositionBox("tool", SE3.from_xyz_rpy((0.1, 0.2, 0.3), (0, 0, 0)), (0.2, 0.4, 0.1))
}
BAND = {"joints": (JointBand("two", -0.1, 0.3),)}


@pytest.mark.parametrize(
    ("constraints", "joint", "low", "high"),
    [(BOX, 0, 0.0, 0.2), (BOX, 1, 0.0, 0.4), (BAND, 1, -0.1, 0.3)],
)
def test_a_constraint_holds_up_to_its_bounds(held, constraints, joint, low, high):
    for bound, outwards in ((low, -1), (high, 1)):
        state = np.array([0.1, 0.1, 0.0, 0.0])
        state[joint] = bound + outwards * 8e-10
        assert held(**constraints).hold(state)
        assert held(**constraints).violation(state) is None
        state[joint] = bound + outwards * 3e-9
        assert not held(**constraints).hold(state)
        assert held(**constraints).violation(state) is not None


def test_what_is_broken_most_is_reported_with_its_value_and_bounds(held):
    both = held(**BOX, **BAND)
    found = both.violation(np.array([0.25, 0.8, 0.0, 0.0]))
    assert found.excess == pytest.approx(0.5)
    assert found.what == "two is at 800 mm, allowed is -100 mm to 300 mm"
    found = both.violation(np.array([0.1, -0.25, 0.0, 0.0]))
    assert found.what == "tool is -450 mm off the box's middle along y, allowed is at most 200 mm"
    record = found.record
    bounds = (record.constraint_lower, record.constraint_upper)
    assert (record.constraint_value, *bounds) == pytest.approx((-0.45, -0.2, 0.2))


def test_an_orientation_is_a_band_about_each_axis_and_a_whole_turn_is_free(held):
    tilted = held(orientation=OrientationBand("tool", np.eye(3), (0.1, 0.1, 0.2)))
    assert (tilted.lower.tolist(), tilted.upper.tolist()) == ([-0.1, -0.1, -0.2], [0.1, 0.1, 0.2])
    assert tilted.narrowest == pytest.approx(0.1)
    assert tilted.hold(np.array([0.0, 0.0, 0.199, 0.0]))
    assert not tilted.hold(np.array([0.0, 0.0, -0.201, 0.0]))
    assert "about z" in tilted.violation(np.array([0.0, 0.0, 0.21, 0.0])).what
    free = held(orientation=OrientationBand("tool", np.eye(3), (0.1, 0.3, np.pi)))
    assert (free.lower[2], free.upper[2]) == (-np.inf, np.inf)
    assert free.hold(np.array([0.0, 0.0, 1.4, 0.0]))


@pytest.mark.parametrize("turned", [0.0, 0.8, 1.4])
def test_equal_tolerances_about_a_free_axis_limit_its_tilt_however_far_it_is_turned(held, turned):
    cone = held(orientation=OrientationBand("tool", np.eye(3), (0.15, 0.15, 3.15)))
    assert cone.upper.tolist() == [0.15]
    assert cone.hold(np.array([0.0, 0.0, turned, 0.1499]))
    assert not cone.hold(np.array([0.0, 0.0, turned, -0.1501]))
    broken = cone.violation(np.array([0.0, 0.0, turned, 0.2]))
    assert broken.what.startswith("tool is tilted 11.5 deg from z")


def test_values_of_many_states_are_those_of_each(held):
    """In the order orientation, box, joints."""
    band = OrientationBand("tool", np.eye(3), (0.1, 0.1, 0.2))
    every = held(orientation=band, **BOX, **BAND)
    assert every.lower.tolist() == [-0.1, -0.1, -0.2, -0.1, -0.2, -0.05, -0.1]
    states = np.array([[0.2, 0.3, 0.1, 0.0], [0.0, 0.1, 0.0, 0.3], [0.4, 0.3, 0.1, 0.2]])
    values = every.values(states)
    assert values[0] == pytest.approx([0, 0, 0.1, 0.1, 0.1, 0.0, 0.3], abs=1e-9)
    assert every.checks == 3
    for state, expected in zip(states, values, strict=True):
        broken = every.violation(state)
        assert (broken is None) == np.all((expected >= every.lower) & (expected <= every.upper))
    assert every.first_violation(states)[0] == 1


def test_a_line_is_checked_as_finely_as_required_and_at_its_end(held):
    """The second joint, of which 0.1 m count as 1 rad, passes its bound at 30 % of the way."""
    band = held(**BAND)
    first, second = np.zeros(4), np.array([0.0, 1.0, 0.0, 0.0])
    assert not band.hold_between(first, second, 1.0)
    assert band.checks == 10
    assert held(**BAND).hold_between(first, np.array([0.0, 0.25, 0.0, 0.0]), 0.1)
    once = held(**BAND)
    assert once.hold_between(second, first, 50.0), "the first end is taken as checked"
    assert once.checks == 1


@pytest.mark.parametrize(
    "band",
    [
        {"orientation": OrientationBand("cup", np.eye(3), (0.1, 0.1, 3.15))},
        {"orientation": OrientationBand("cup", np.eye(3), (0.1, 0.2, 3.15))},
        {"orientation": OrientationBand("cup", np.eye(3), (0.1, 0.2, 0.3))},
        {"position": PositionBox("cup", at(0.1, 0.2, 0.35, (0.3, 0.2, 0.1)), (0.2, 0.2, 0.2))},
    ],
)
def test_states_are_projected_well_inside_what_an_attached_object_keeps(scene, held, band):
    """The cup lies across the tool; the constraints are those of the cup and not of the tool."""
    scene.add_object(thing("cup", at(0, 0, 0), Shape(Box((0.1, 0.1, 0.1)))), at(0.1, 0.0, 0.4))
    scene.attach_object("cup", "tool", (), np.zeros(4))
    constraints = held(**band)
    for start in np.random.default_rng(3).uniform(-0.5, 0.5, (20, 4)):
        state = constraints.project(start)
        assert state is not None
        values = constraints.values(state[None])[0]
        assert np.all(np.abs(values) < constraints.upper - 0.09 * np.minimum(constraints.upper, 1))


def test_a_state_is_projected_inside_its_bounds_and_the_joint_limits(held):
    def along(value, **constraints):
        state = held(**constraints).project(np.array([0.5, value, 0.0, 0.0]))
        return None if state is None else state.tolist()

    assert along(0.9, **BAND) == pytest.approx([0.5, 0.26, 0.0, 0.0])
    assert along(-0.9, **BAND) == pytest.approx([0.5, -0.06, 0.0, 0.0])
    assert along(0.255, **BAND) == [0.5, 0.255, 0.0, 0.0]
    assert along(0.0, joints=(JointBand("two", 1.6, 2.0),)) is None
    assert along(0.0, joints=(JointBand("two", 0.2, np.inf),)) == pytest.approx([0.5, 0.2, 0, 0])


def test_what_is_neither_a_link_nor_attached_is_refused(scene, held):
    scene.add_object(thing("cup", at(0, 0, 0), Shape(Box((0.1, 0.1, 0.1)))), at(0.1, 0.0, 0.4))
    with pytest.raises(PlanningFailed, match="'cup' is neither a link nor an attached object"):
        held(orientation=OrientationBand("cup", np.eye(3), (0.1, 0.1, 3.15)))


def test_a_line_near_a_bound_holds_but_is_not_inside(held):
    """Projected states keep 10 % of the width from a bound, or 5 % with rounding by steps."""
    band, first = held(**BAND), np.zeros(4)
    for end, is_inside in ((0.27, True), (0.29, False)):
        second = np.array([0.0, end, 0.0, 0.0])
        assert band.hold_between(first, second, 0.1)
        assert band.are_inside(first, second, 0.1) == is_inside
