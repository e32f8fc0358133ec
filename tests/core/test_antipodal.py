"""Two contacts hold an object between them by their directions and places."""

import numpy as np
import pytest

from harness.core.antipodal import (
    combined_press,
    distance_pressed,
    is_antipodal,
    least_thickness,
)
from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere


def press(place, force):
    return np.array([[*place, *force]], dtype=float)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (press((0, -0.02, 0), (0, 1, 0)), press((0, 0.02, 0), (0, -1, 0)), True),
        (press((0, -0.02, 0), (0, -1, 0)), press((0, 0.02, 0), (0, 1, 0)), True),
        (press((0, -0.02, 0), (0, 0, -1)), press((0, 0.02, 0), (0, 0, -1)), False),
        (press((0, -0.02, 0), (0, 0.1, -1)), press((0, 0.02, 0), (0, -0.1, -1)), False),
        (press((0, -0.005, 0), (0, 1, 0)), press((0, 0.005, 0), (0, -1, 0)), False),
        (press((0, -0.02, 0), (0, 0, 0)), press((0, 0.02, 0), (0, -1, 0)), False),
    ],
    ids=["pads", "inside a ring", "on top", "on a ridge", "at an edge", "one alone"],
)
def test_only_opposite_forces_at_places_as_far_apart_as_the_object_is_thick(
    first, second, expected
):
    assert bool(is_antipodal(first, second, 0.04)[0]) is expected


@pytest.mark.parametrize(("degrees", "expected"), [(0, True), (20, True), (44, True), (46, False)])
def test_a_ball_is_held_within_the_cone_of_a_friction_of_one(degrees, expected):
    angle, radius = np.radians(degrees), 0.02
    side = radius * np.array([0, -np.cos(angle), np.sin(angle)])
    other = side * (1, -1, 1)
    grip = is_antipodal(press(side, -side), press(other, -other), 2 * radius)
    assert bool(grip[0]) is expected


def test_several_links_press_where_the_strongest_does():
    weak, strong = press((0, 0, 0.1), (0, 1, 0)), press((0, 0, 0.02), (0, 3, 0))
    together = combined_press([weak, strong, np.full((1, 6), np.nan)])
    assert together[0] == pytest.approx([0, 0, 0.04, 0, 4, 0])
    assert combined_press([np.full((1, 6), np.nan)])[0] == pytest.approx(np.zeros(6))
    assert distance_pressed(together, press((0.5, 0.03, 0), (0, -4, 0)))[0] == pytest.approx(0.03)


def test_the_thinnest_shape_counts():
    shapes = (Shape(Box((0.1, 0.02, 0.3))), Shape(Cylinder(0.03, 0.05)), Shape(Sphere(0.02)))
    assert least_thickness(shapes) == 0.02
    assert least_thickness(shapes[1:]) == 0.04
    assert least_thickness((Shape(Capsule(0.01, 0.2)),)) == 0.02
    assert least_thickness((Shape(Plane()),)) == least_thickness(()) == 0.0
