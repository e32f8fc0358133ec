"""Bounds of path constraints on both of their sides, on a robot of two prismatic joints."""

from types import SimpleNamespace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.planning.verification.path_constraints import HeldConstraints
from harness.ports.goals import JointBand, OrientationBand, PathConstraints, PositionBox

ROBOT = SimpleNamespace(
    link_pose=lambda q, _: SE3.from_xyz_rpy((q[0], 2 * q[1], 0.3), (0, 0, 0.5 * q[0]))
)


class Space:
    """The link is at (q0, 2 q1, 0.3), turned by q0 / 2 about z."""

    joint_names = ("one", "two")
    dof = 2
    robot = ROBOT
    lower, upper = np.array([-1.0, -1.0]), np.array([1.0, 1.0])

    def whole(self, positions):
        return positions

    def distance(self, first, second):
        return float(np.linalg.norm(second - first))


def held(**constraints):
    return HeldConstraints(PathConstraints(**constraints), Space())


BOX = {"position": PositionBox("tool", SE3.from_xyz_rpy((0.1, 0.2, 0.3)), (0.2, 0.4, 0.1))}
BAND = {"joints": (JointBand("two", -0.1, 0.3),)}


@pytest.mark.parametrize(
    ("constraints", "joint", "low", "high"),
    [(BOX, 0, 0.0, 0.2), (BOX, 1, 0.0, 0.2), (BAND, 1, -0.1, 0.3)],
)
def test_a_constraint_holds_up_to_its_bounds(constraints, joint, low, high):
    for bound, outwards in ((low, -1), (high, 1)):
        state = np.array([0.1, 0.1])
        state[joint] = bound + outwards * 4e-10
        assert held(**constraints).hold(state)
        assert held(**constraints).violation(state) is None
        state[joint] = bound + outwards * 2e-9
        assert not held(**constraints).hold(state)
        assert held(**constraints).violation(state) is not None


def test_a_bound_may_be_missed_by_a_nanoradian_exactly():
    constraints = held(joints=(JointBand("two", 0.0, 0.0),))
    for value, expected in ((1e-9, True), (-1e-9, True), (1.1e-9, False), (-1.1e-9, False)):
        state = np.array([0.0, value])
        assert constraints.hold(state) is expected
        assert (constraints.violation(state) is None) is expected


def test_what_is_broken_most_is_reported_with_its_value_and_bounds():
    both = held(**BOX, **BAND)
    found = both.violation(np.array([0.25, 0.4]))
    assert found.excess == pytest.approx(0.4)
    assert found.what == "tool is 0.6000 m off the box's middle along y, -0.2 to 0.2 are allowed"
    record = found.record
    bounds = (record.constraint_lower, record.constraint_upper)
    assert (record.constraint_value, *bounds) == pytest.approx((0.6, -0.2, 0.2))
    found = both.violation(np.array([0.1, -0.15]))
    assert found.what.startswith("tool is -0.5000 m off")
    only = held(**BAND).violation(np.array([0.0, 0.35]))
    assert only.what == "two is at 0.3500, -0.1 to 0.3 are allowed"
    assert only.excess == pytest.approx(0.05)


def test_an_orientation_is_a_band_about_each_axis_and_a_whole_turn_is_free():
    band = OrientationBand("tool", np.eye(3), (0.1, 0.1, 0.2))
    tilted = held(orientation=band)
    assert (tilted.lower.tolist(), tilted.upper.tolist()) == ([-0.1, -0.1, -0.2], [0.1, 0.1, 0.2])
    assert tilted.narrowest == pytest.approx(0.1)
    assert tilted.hold(np.array([0.399, 0.0]))
    assert not tilted.hold(np.array([-0.401, 0.0]))
    assert "about z" in tilted.violation(np.array([0.41, 0.0])).what
    free = held(orientation=OrientationBand("tool", np.eye(3), (0.1, 0.3, np.pi)))
    assert (free.lower[2], free.upper[2]) == (-np.inf, np.inf)
    assert free.hold(np.array([1.0, 0.0]))


def test_the_order_of_values_is_orientation_box_joints():
    band = OrientationBand("tool", np.eye(3), (0.1, 0.1, 0.2))
    every = held(orientation=band, **BOX, **BAND)
    values = every.values(np.array([0.2, 0.3]))
    assert values == pytest.approx([0, 0, 0.1, 0.1, 0.4, 0.0, 0.3], abs=1e-9)
    assert every.checks == 1
    assert every.lower.tolist() == [-0.1, -0.1, -0.2, -0.1, -0.2, -0.05, -0.1]
    assert every.narrowest == pytest.approx(0.05)


def test_a_line_is_checked_as_finely_as_required_and_at_its_end():
    """The second joint passes its bound at 30 % of the way."""
    band = held(**BAND)
    first, second = np.array([0.0, 0.0]), np.array([0.0, 1.0])
    assert not band.hold_between(first, second, 0.1)
    assert band.checks == 4
    inside = held(**BAND)
    assert inside.hold_between(first, np.array([0.0, 0.25]), 0.1)
    assert inside.checks == 3
    once = held(**BAND)
    assert once.hold_between(second, first, 5.0), "the first end is taken as checked"
    assert once.checks == 1
    assert held(**BAND).hold_between(first, first, 0.1)


def test_a_state_is_projected_well_inside_its_bounds_and_the_joint_limits():
    """Inner bounds are a tenth of the width inside: 0.26 and -0.06 of the band."""
    assert held(**BAND).project(np.array([0.5, 0.9])) == pytest.approx([0.5, 0.26])
    assert held(**BAND).project(np.array([0.5, -0.9])) == pytest.approx([0.5, -0.06])
    assert held(**BAND).project(np.array([0.5, 0.255])).tolist() == [0.5, 0.255]
    assert held(**BOX).project(np.array([0.9, 0.9])) == pytest.approx([0.18, 0.18])
    assert held(joints=(JointBand("two", 1.5, 2.0),)).project(np.array([0.0, 0.0])) is None
    unbounded = held(joints=(JointBand("two", 0.2, np.inf),))
    assert unbounded.project(np.array([0.0, 0.0])) == pytest.approx([0.0, 0.2])
