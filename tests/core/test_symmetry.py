"""Turns about the vertical after which an object stands as before."""

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.symmetry import ANY, equal_turns

UPRIGHT, LYING, LEANING = (0, 0, 0.7), (np.pi / 2, 0, 0.7), (0.01, 0, 0.7)
ROD = Cylinder(0.02, 0.1)


def shape(geometry, x=0.0, z=0.0, rpy=(0, 0, 0)):
    return Shape(geometry, SE3.from_xyz_rpy((x, 0, z), rpy))


@pytest.mark.parametrize(
    ("shapes", "rpy", "turns"),
    [
        ([shape(ROD)], UPRIGHT, ANY),
        ([shape(ROD, z=0.05)], UPRIGHT, ANY),
        ([shape(ROD, z=0.05)], LYING, 1),
        ([shape(ROD)], LYING, 2),
        ([shape(ROD)], LEANING, 1),
        ([shape(Capsule(0.02, 0.1))], UPRIGHT, ANY),
        ([shape(Sphere(0.02))], LEANING, ANY),
        ([shape(Sphere(0.02), x=0.01)], UPRIGHT, 1),
        ([shape(Box((0.04, 0.05, 0.1)))], UPRIGHT, 2),
        ([shape(Box((0.04, 0.04, 0.1)))], UPRIGHT, 4),
        ([shape(Box((0.04, 0.04, 0.1)))], LYING, 2),
        ([shape(Box((0.04, 0.05, 0.1)), rpy=(0.2, 0, 0))], UPRIGHT, 1),
        ([shape(ROD), shape(Box((0.04, 0.05, 0.1)))], UPRIGHT, 2),
        ([shape(Box((0.1, 0.1, 0.1))), shape(Box((0.04, 0.05, 0.1)), z=0.1)], UPRIGHT, 2),
        ([shape(ROD), shape(Box((0.01, 0.01, 0.01)), x=0.05)], UPRIGHT, 1),
        ([shape(Plane())], UPRIGHT, 1),
        ([], UPRIGHT, 1),
    ],
)
def test_what_an_object_looks_like_says_how_it_may_be_turned(shapes, rpy, turns):
    assert equal_turns(shapes, SE3.from_xyz_rpy(rpy=rpy).rotation) == turns
