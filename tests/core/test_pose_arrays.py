"""Batched pose algebra against SE3, and lowest points against sampled surfaces."""

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Shape, Sphere
from harness.core.pose_arrays import (
    angle_between,
    compose,
    quat_product,
    relative,
    rotate,
    rotation_angle,
    rotation_vector,
)
from harness.core.spatial import SE3
from harness.judging.support import lowest_points
from harness.recording.run import ObjectRecord

RNG = np.random.default_rng(3)
POSES = [SE3.from_xyz_rpy(RNG.normal(size=3), RNG.uniform(-3, 3, 3)) for _ in range(20)]
ROWS = np.array([pose.as_vector() for pose in POSES])
SHIFTED, SHIFTED_ROWS = [*POSES[1:], POSES[0]], np.roll(ROWS, -1, axis=0)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def matrices(rows):
    return np.array([SE3.from_vector(row).matrix() for row in rows])


def test_composition_is_that_of_matrices():
    expected = [(a @ b).matrix() for a, b in zip(POSES, SHIFTED, strict=True)]
    np.testing.assert_allclose(matrices(compose(ROWS, SHIFTED_ROWS)), expected, atol=1e-12)


def test_a_relative_pose_undoes_composition():
    expected = [(a.inverse() @ b).matrix() for a, b in zip(POSES, SHIFTED, strict=True)]
    np.testing.assert_allclose(matrices(relative(ROWS, SHIFTED_ROWS)), expected, atol=1e-12)
    assert relative(ROWS[0], ROWS).shape == (20, 7)


def test_rotating_is_the_matrix_times_the_vector():
    vector = np.array([0.3, -1.0, 2.0])
    expected = [pose.rotation @ vector for pose in POSES]
    np.testing.assert_allclose(rotate(ROWS[:, 3:], vector), expected, atol=1e-12)


def test_angles_are_those_of_se3_and_independent_of_the_quaternion_s_sign():
    turns = quat_product(ROWS[:, 3:] * [1, -1, -1, -1], SHIFTED_ROWS[:, 3:])
    expected = [a.distance_to(b)[1] for a, b in zip(POSES, SHIFTED, strict=True)]
    for quats in (turns, -turns):
        np.testing.assert_allclose(rotation_angle(quats), expected, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(rotation_vector(quats), axis=1), expected)


def test_a_quarter_turn_about_z_is_known():
    quarter = SE3.from_xyz_rpy(rpy=(0, 0, np.pi / 2)).quat_wxyz
    np.testing.assert_allclose(rotation_vector(quarter), [0, 0, np.pi / 2], atol=1e-15)
    np.testing.assert_allclose(rotation_vector(np.array([1.0, 1e-13, 0, 0]))[0], 2e-13)


def test_a_tiny_angle_is_not_lost():
    a, b = np.array([0.0, 0, 1]), np.array([1e-10, 0, 1])
    assert angle_between(a, b) == pytest.approx(1e-10)


@pytest.mark.parametrize(
    ("geometry", "surface"),
    [
        (Box((0.2, 0.4, 0.6)), lambda u: np.sign(u) * [0.1, 0.2, 0.3]),
        (Sphere(0.3), lambda u: 0.3 * u),
        (Capsule(0.1, 0.5), lambda u: 0.1 * u + np.sign(u[:, 2:]) * [0, 0, 0.25]),
        (
            Cylinder(0.2, 0.5),
            lambda u: np.column_stack([0.2 * unit(u[:, :2]), 0.25 * np.sign(u[:, 2])]),
        ),
    ],
    ids=["box", "sphere", "capsule", "cylinder"],
)
def test_the_lowest_point_is_that_of_the_surface(geometry, surface):
    shape = Shape(geometry, SE3.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)))
    record = ObjectRecord("thing", False, True, True, (shape,), ())
    directions = RNG.normal(size=(40_000, 3))
    points = surface(unit(directions))
    lowest = lowest_points(record, ROWS)
    for pose, height in zip(POSES, lowest, strict=True):
        sampled = (pose @ shape.pose).apply(points)[:, 2].min()
        assert height == pytest.approx(sampled, abs=2e-3)
        assert height <= sampled + 1e-12
