import math

import numpy as np
import pytest

from harness.core.geometry import (
    Box,
    Capsule,
    Cylinder,
    Mesh,
    Plane,
    Shape,
    Sphere,
    bounding_radius,
)
from harness.core.spatial import SE3


@pytest.mark.parametrize(
    ("geometry", "radius"),
    [
        (Box((2, 2, 1)), 1.5),
        (Sphere(0.3), 0.3),
        (Cylinder(3, 8), 5.0),
        (Capsule(1, 4), 3.0),
        (Plane(), math.inf),
        (Mesh(path="a.stl"), math.inf),
    ],
)
def test_the_bounding_sphere_just_holds_the_shape(geometry, radius):
    assert bounding_radius(Shape(geometry)) == pytest.approx(radius)


def test_a_shape_off_its_body_needs_a_larger_sphere():
    shape = Shape(Sphere(1.0), SE3.from_xyz_rpy((0, 3, 4)))
    assert bounding_radius(shape) == pytest.approx(6.0)


def test_the_bounding_sphere_holds_every_corner_of_a_turned_box():
    box = Box((0.4, 0.2, 0.6))
    pose = SE3.from_xyz_rpy((0.1, -0.2, 0.3), (0.3, 0.4, 0.5))
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    corners = pose.apply(0.5 * signs * np.array(box.size))
    assert np.linalg.norm(corners, axis=1).max() <= bounding_radius(Shape(box, pose)) + 1e-12
