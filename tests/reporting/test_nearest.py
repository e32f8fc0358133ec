"""Nearest points of two bodies against closed forms, and against what a run recorded."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.recording.verdict import Measure, Verdict
from harness.reporting.html.nearest import nearest_points
from tests.judging.synthetic_run import BOX, make_run

TURNED = SE3.from_xyz_rpy((0, 0, 0), (0.4, -0.7, 0.2))


def judged(run, value, pair=("one", "two")):
    measure = Measure("clearance", value, 0.1, ">=", "m", 0.0, " and ".join(pair), plot="clearance")
    return nearest_points(run, Verdict("", "passed", time=0.0, measures=(measure,)))


def placed(name, geometry, xyz, rotation=None):
    pose = SE3.from_xyz_rpy(xyz) @ (rotation or SE3.identity())
    return replace(BOX, name=name, shapes=(Shape(geometry),), pose=tuple(pose.as_vector()))


def apart(one, two, value):
    points = judged(make_run(objects=(one, two)), value)
    return (
        None
        if points is None
        else float(np.linalg.norm(np.subtract(points["expected"], points["actual"])))
    )


CORNER = Box((0.2, 0.2, 0.2))
LYING = placed("one", Capsule(0.1, 0.4), (0, 0, 0))
TILTED = placed("one", Box((0.2, 0.4, 0.6)), (0, 0, 0), TURNED)


@pytest.mark.parametrize(
    ("one", "two", "distance"),
    [
        (placed("one", Sphere(0.1), (0, 0, 0)), placed("two", Sphere(0.2), (0, 0, 1)), 0.7),
        (placed("one", CORNER, (0, 0, 0)), placed("two", Sphere(0.1), (1, 1, 1)), 1.4589),
        (placed("one", Cylinder(0.1, 0.4), (0, 0, 0)), placed("two", Plane(), (0, 0, -1)), 0.8),
        (LYING, placed("two", Capsule(0.1, 0.4), (0.5, 0, 0)), 0.3),
        (TILTED, placed("two", Sphere(0.05), (0, 0, 2)), None),
    ],
)  # fmt: skip
def test_nearest_points_are_as_far_apart_as_the_shapes(one, two, distance):
    if distance is None:  # the corner of a turned box that is highest
        corners = np.array(np.meshgrid([-0.1, 0.1], [-0.2, 0.2], [-0.3, 0.3])).reshape(3, -1)
        tops = (TURNED.matrix()[:3, :3] @ corners).T
        distance = np.linalg.norm(tops - (0, 0, 2), axis=1).min() - 0.05
    assert apart(one, two, distance) == pytest.approx(distance, abs=2e-4)


def test_points_that_are_not_as_far_apart_as_was_judged_are_not_shown():
    one, two = placed("one", Sphere(0.1), (0, 0, 0)), placed("two", Sphere(0.1), (0, 0, 1))
    assert apart(one, two, 0.8) is not None
    assert apart(one, two, 0.7) is None
    assert apart(one, placed("two", Sphere(0.1), (0, 0, 0.1)), -0.1) is None, "they overlap"
    assert judged(make_run(objects=(one,)), 0.8) is None, "the other is not there"
