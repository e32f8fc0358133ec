"""beam: a light barrier is interrupted by an object, or free."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Hull, Mesh, Plane, Shape, Sphere
from harness.core.pose_arrays import conjugate, rotate
from harness.core.spatial import SE3
from harness.plugins.fixtures.blocked_beam import blocked_length
from harness.plugins.fixtures.expectations.beam import Beam
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import TABLE, at, make_run, step, thing, verdict

ENDS = {"from": {"xyz": [0.0, -0.2, 0.02]}, "to": {"xyz": [0.0, 0.2, 0.02]}}
BALL = thing("ball", Sphere(0.02))
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.05


def beam(**more):
    return Beam.model_validate({**ENDS, **more})


def ball_at(*x, n=200):
    """A run in which a ball stands at places along x, each for an equal time."""
    rows = at(n, (0.0, 0.0, 0.02))
    rows[:, 0] = np.repeat(np.array(x, dtype=float), n // len(x))
    steps = (step("early", 0, 100), step("late", 100, n))
    return make_run(objects=(TABLE, BALL), object_poses={"ball": rows}, steps=steps)


def off(chord):
    """The distance of a beam from the ball's middle of which this length is inside [m]."""
    return np.sqrt(0.02**2 - (chord / 2) ** 2)


EVIDENCE = Evidence(
    three_runs=(
        Three(beam(), ball_at(0.0), ball_at(off(0.95e-4)), -5e-6, "m"),
        Three(beam(interrupted=False), ball_at(0.1), ball_at(off(1.05e-4)), -5e-6, "m"),
    ),
    mutation_cases=((beam(object="ball"), ball_at(0.1, 0.0), "late"),),
    free_shifts=(
        Free(
            "a ball looks the same from every side, and the beam is long",
            "beam",
            "object_poses ball",
            "+-roll +-pitch +-yaw",
        ),
    ),
    picture=(
        ("barrier", "{from: [0.3, -0.13, 0.03], to: [0.3, 0.13, 0.03]}"),
        ("barrier", "{from: [0.3, -0.13, 0.1], to: [0.3, 0.13, 0.1]}"),
    ),
)


def solid(geometry, points):
    """Whether points in its frame are inside a shape."""
    x, y, z = np.moveaxis(points, -1, 0)
    match geometry:
        case Sphere(radius=r):
            return x * x + y * y + z * z <= r * r
        case Box(size=size):
            return (np.abs(points) <= np.array(size) / 2).all(axis=-1)
        case Cylinder(radius=r, length=length):
            return (x * x + y * y <= r * r) & (np.abs(z) <= length / 2)
        case Capsule(radius=r, length=length):
            rest = np.maximum(np.abs(z) - length / 2, 0)
            return x * x + y * y + rest * rest <= r * r
        case Plane():
            return z <= 0
        case Mesh():
            return (np.abs(points) <= 0.05).all(axis=-1)


SHAPES = [
    Sphere(0.08),
    Box((0.1, 0.06, 0.2)),
    Cylinder(0.05, 0.12),
    Capsule(0.04, 0.1),
    Plane(),
    Mesh("cube.stl", hull=Hull(tuple(map(tuple, CUBE)), 0.001, (0.0, 0.0, 0.0), 0.1)),
]


@pytest.mark.parametrize("geometry", SHAPES, ids=lambda each: type(each).__name__)
def test_the_blocked_length_is_that_of_the_points_inside(geometry):
    rng, n, parts = np.random.default_rng(5), 60, 4001
    quats = rng.normal(size=(n, 4))
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    poses = np.hstack([rng.uniform(-0.1, 0.1, (n, 3)), quats])
    ends = rng.uniform(-0.2, 0.2, (2, n, 3))
    placed = Shape(geometry, SE3.from_xyz_rpy((0.02, -0.01, 0.03), (0.3, 0.2, 0.1)))
    record = replace(thing("body"), shapes=(placed,))
    shares = np.linspace(0, 1, parts)[:, None, None]
    points = ends[0] + shares * (ends[1] - ends[0])
    local = placed.pose.inverse().apply(rotate(conjugate(quats), points - poses[:, :3]))
    length = np.linalg.norm(ends[1] - ends[0], axis=1)
    counted = solid(geometry, local).sum(axis=0) / parts * length
    found = blocked_length(record, poses, ends)
    assert (found > 0).any()
    assert (found == 0).any()
    assert found == pytest.approx(counted, abs=3 * 0.7 / parts)


@pytest.mark.parametrize("way", [(0, 0, 1), (1, 0, 0)])
def test_a_beam_along_an_axis_of_a_cylinder(way):
    way = np.array(way, dtype=float)
    ends = np.stack([at(1, -0.5 * way)[:, :3], at(1, 0.5 * way)[:, :3]])
    record = thing("can", Cylinder(0.03, 0.1))
    expected = 0.1 if way[2] else 0.06
    assert blocked_length(record, at(1), ends) == pytest.approx([expected])
    assert blocked_length(record, at(1, (0.04, 0.04, 0.2)), ends) == pytest.approx([0.0])


def test_what_is_absent_interrupts_nothing_and_the_planner_s_objects_are_not_seen():
    run = ball_at(0.0)
    gone = {**run.signals.object_poses, "ball": np.full((200, 7), np.nan)}
    absent = replace(run, signals=replace(run.signals, object_poses=gone))
    assert verdict(absent, beam(interrupted=False)).status == "passed"
    believed = replace(run, objects=(TABLE, replace(BALL, in_simulation=False)))
    assert verdict(believed, beam(interrupted=False)).status == "passed"


def test_a_verdict_says_what_interrupts_the_beam():
    answer = verdict(ball_at(0.0), beam())
    assert answer.reason.startswith("ball interrupts the beam: 40.0 mm of it are inside")
    assert verdict(ball_at(0.1), beam()).reason.startswith("nothing interrupts the beam")
