"""What the scene draws: closed surfaces that face outwards, and not too many triangles."""

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot

scene_view = pytest.importorskip("harness.plugins.studio.scene_view")


@pytest.mark.parametrize(
    ("geometry", "volume"),
    [
        (Box((0.1, 0.2, 0.3)), 0.006),
        (Cylinder(0.1, 0.3), np.pi * 0.01 * 0.3),
        (Sphere(0.1), 4 / 3 * np.pi * 0.001),
        (Capsule(0.1, 0.3), np.pi * 0.01 * 0.3 + 4 / 3 * np.pi * 0.001),
        (Plane(), scene_view.PLANE_SIZE**2 * 0.002),
    ],
)
def test_a_shape_is_a_closed_surface_that_faces_outwards(geometry, volume):
    [part] = scene_view.triangles_of([Shape(geometry)])
    corners = part.vertices[part.faces]
    enclosed = (
        np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    )
    assert enclosed == pytest.approx(volume, rel=0.05)


@pytest.mark.parametrize("model", ["ur3e", "ur10e", "open_manipulator_x"])
def test_a_robot_has_at_most_20000_triangles(model):
    links = scene_view.robot_triangles(load_robot(RobotSpec(model=model)))
    count = sum(len(part.faces) for parts in links.values() for part in parts)
    assert 500 < count <= 20_000
