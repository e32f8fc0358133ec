"""The pinhole against known numbers."""

import numpy as np
import pytest

from harness.core.camera import OPTICAL, Camera
from harness.core.spatial import SE3

GRIPPER_CAMERA = Camera("gripper_camera", "link", horizontal_fov=1.3962634)


def test_intrinsics_are_those_of_the_lessons_camera_info():
    assert GRIPPER_CAMERA.focal_length == pytest.approx(381.3612, abs=1e-4)
    assert GRIPPER_CAMERA.vertical_fov == pytest.approx(1.123406, abs=1e-6)
    np.testing.assert_allclose(GRIPPER_CAMERA.matrix[:2, 2], [320.0, 240.0])


def test_the_optical_frame_has_z_forward_and_x_to_the_right():
    np.testing.assert_allclose(OPTICAL.rotation @ [0, 0, 1], [1, 0, 0])
    np.testing.assert_allclose(OPTICAL.rotation @ [1, 0, 0], [0, -1, 0])
    exact = SE3.from_xyz_rpy((0, 0, 0), (-np.pi / 2, 0, -np.pi / 2))
    np.testing.assert_allclose(OPTICAL.rotation, exact.rotation, atol=1e-12)


def test_a_point_at_half_the_field_of_view_is_at_the_edge_of_the_picture():
    half = GRIPPER_CAMERA.horizontal_fov / 2
    points = np.array([[np.sin(half), 0, np.cos(half)], [0, 0, 2.0], [0.0, 0.0, -1.0]])
    pixels = GRIPPER_CAMERA.project(points)
    np.testing.assert_allclose(pixels[:2], [[640, 240], [320, 240]], atol=1e-9)
    assert np.isnan(pixels[2]).all()
