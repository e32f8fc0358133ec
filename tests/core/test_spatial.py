import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.spatial import (
    SE3,
    quat_wxyz_from_rotation,
    rotation_from_quat_wxyz,
    rotation_from_rpy,
    wxyz_from_xyzw,
    xyzw_from_wxyz,
)

HALF = math.sqrt(0.5)
angles = st.floats(-math.pi, math.pi)
lengths = st.floats(-10, 10)
poses = st.builds(
    SE3.from_xyz_rpy,
    st.tuples(lengths, lengths, lengths),
    st.tuples(angles, st.floats(-1.5, 1.5), angles),
)


@pytest.mark.parametrize(
    ("rpy", "quat_wxyz"),
    [
        ((0, 0, 0), (1, 0, 0, 0)),
        ((0, 0, math.pi / 2), (HALF, 0, 0, HALF)),
        ((math.pi / 2, 0, 0), (HALF, HALF, 0, 0)),
        ((0, math.pi / 2, 0), (HALF, 0, HALF, 0)),
        ((math.pi / 2, 0, math.pi / 2), (0.5, 0.5, 0.5, 0.5)),  # fixed axes: roll first
    ],
)
def test_conventions_are_pinned_by_known_rotations(rpy, quat_wxyz):
    rotation = rotation_from_rpy(rpy)
    assert rotation == pytest.approx(rotation_from_quat_wxyz(quat_wxyz), abs=1e-15)
    assert quat_wxyz_from_rotation(rotation) == pytest.approx(quat_wxyz, abs=1e-15)


def test_a_yaw_turns_x_to_y():
    turned = SE3.from_xyz_rpy((1, 2, 3), (0, 0, math.pi / 2)).apply(np.array([1.0, 0.0, 0.0]))
    assert turned == pytest.approx([1, 3, 3])


def test_the_orders_of_quaternions_are_distinguished():
    assert list(wxyz_from_xyzw((1, 2, 3, 4))) == [4, 1, 2, 3]
    assert list(xyzw_from_wxyz((4, 1, 2, 3))) == [1, 2, 3, 4]


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_keep_their_axis(axis):
    rotation = -np.eye(3)
    rotation[axis, axis] = 1
    expected = np.zeros(4)
    expected[axis + 1] = 1
    assert quat_wxyz_from_rotation(rotation) == pytest.approx(expected)


@given(poses)
def test_a_pose_times_its_inverse_is_nothing(pose):
    distance, angle = (pose @ pose.inverse()).distance_to(SE3.identity())
    assert distance < 1e-12
    assert angle < 1e-7


@given(poses, poses, poses)
def test_composition_is_that_of_matrices_and_associative(a, b, c):
    assert (a @ b).matrix() == pytest.approx(a.matrix() @ b.matrix(), abs=1e-12)
    assert ((a @ b) @ c).matrix() == pytest.approx((a @ (b @ c)).matrix(), abs=1e-10)


@given(poses)
def test_vectors_and_matrices_give_the_pose_back(pose):
    for again in (SE3.from_vector(pose.as_vector()), SE3.from_matrix(pose.matrix())):
        assert again.matrix() == pytest.approx(pose.matrix(), abs=1e-12)
    assert pose.quat_wxyz[0] >= 0
    assert np.linalg.norm(pose.quat_wxyz) == pytest.approx(1)


@given(poses, poses, st.lists(st.tuples(lengths, lengths, lengths), min_size=1, max_size=4))
def test_points_move_as_the_composed_pose_says(a, b, points):
    points = np.array(points)
    assert (a @ b).apply(points) == pytest.approx(a.apply(b.apply(points)), abs=1e-10)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 1.0, math.pi - 1e-9, math.pi])
def test_the_angle_between_poses_is_exact_near_zero_and_near_a_half_turn(angle):
    here, there = SE3.from_xyz_rpy((1, 0, 0)), SE3.from_xyz_rpy((1, 3, 4), (0, 0, angle))
    distance, turned = here.distance_to(there)
    assert distance == pytest.approx(5)
    assert turned == pytest.approx(angle, abs=1e-12)


def test_a_quaternion_is_normalised_before_use():
    pose = SE3.from_xyz_quat((0, 0, 0), (2, 0, 0, 2))
    assert pose.quat_wxyz == pytest.approx([HALF, 0, 0, HALF])
