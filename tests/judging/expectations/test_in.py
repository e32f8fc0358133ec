"""in: inside the outline of a container that stands."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.judging.window import Window
from harness.plugins.objects.expectations.in_ import In, outline
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.surfaces import GEOMETRIES, surface_of
from tests.judging.synthetic_run import BOX, at, make_run, thing, verdict

ABSENT = np.full((200, 7), np.nan)


def a_bin(name="bin", lean=0.0, x=0.0):
    """A tray of 20 x 20 x 10 cm made of a floor and two walls; its origin is in its middle."""
    parts = [
        Shape(Box((0.2, 0.2, 0.01)), SE3.from_xyz_rpy((0, 0, -0.045))),
        Shape(Box((0.01, 0.2, 0.1)), SE3.from_xyz_rpy((-0.095, 0, 0))),
        Shape(Cylinder(0.05, 0.2), SE3.from_xyz_rpy((0.05, 0, 0), (np.pi / 2, 0, 0))),
    ]
    record = replace(thing(name, static=True), shapes=tuple(parts))
    return record, at(200, (x, 0, 0.05), SE3.from_xyz_rpy(rpy=(lean, 0, 0)).quat_wxyz)


def in_bin(lean=0.0, x=0.0, box=(0, 0, 0.03)):
    record, poses = a_bin(lean=lean, x=x)
    return make_run(objects=(BOX, record), object_poses={"bin": poses, "box": at(200, box)})


def test_what_is_inside_the_outline_of_a_container_is_in_it():
    spec = In(object="box", container="bin")
    answer = verdict(in_bin(), spec)
    assert (answer.status, answer.unit) == ("passed", "rad"), "the lean is the tighter of the two"
    outside = verdict(in_bin(x=0.101), spec)
    assert (outside.status, outside.unit, outside.margin) == ("failed", "m", pytest.approx(-0.001))
    assert verdict(in_bin(box=(0, 0, 0.099)), spec).margin == pytest.approx(0.001)
    assert verdict(in_bin(box=(0, 0, 0.101)), spec).status == "failed", "above its rim"


@pytest.mark.parametrize("missing", range(4))
def test_three_sides_without_a_floor_enclose_nothing(missing):
    """Boards around an origin that is off the middle; no way to the missing one is a diagonal."""
    ways = ((1, 0), (-1, 0), (0, 1), (0, -1))
    boards = [
        Shape(
            Box((0.01 if x else 0.2, 0.2 if x else 0.01, 0.1)),
            SE3.from_xyz_rpy((0.095 * x, 0.095 * y, 0)),
        )
        for x, y in ways
    ]
    for shapes, status in (
        (boards, "passed"),
        (boards[:missing] + boards[missing + 1 :], "failed"),
    ):
        corner = Shape(Box((0.001, 0.001, 0.1)), SE3.from_xyz_rpy((0.0995, 0.0995, 0)))
        other = Shape(Box((0.001, 0.001, 0.1)), SE3.from_xyz_rpy((-0.0995, -0.0995, 0)))
        record = replace(thing("bin", static=True), shapes=(*shapes, corner, other))
        poses = {"bin": at(200, (0, 0, 0.05)), "box": at(200, (0.01, 0.02, 0.05))}
        run = make_run(objects=(BOX, record), object_poses=poses)
        assert verdict(run, In(object="box", container="bin")).status == status


MESH = Mesh(Path("part.stl"))


@pytest.mark.parametrize(
    ("inside", "outside", "status"),
    [
        (Cylinder(0.02, 0.04), Box((0.036, 0.036, 0.04)), "failed"),  # 50.3 and 51.8 cm3
        (Cylinder(0.02, 0.04), Box((0.035, 0.035, 0.04)), "passed"),  # 49.0 cm3
        (Sphere(0.02), Box((0.033, 0.033, 0.033)), "failed"),  # 33.5 and 35.9 cm3
        (Box((0.032, 0.032, 0.032)), Sphere(0.02), "failed"),  # 32.8 cm3
        (Capsule(0.01, 0.02), Cylinder(0.01, 0.03), "passed"),  # 10.5 and 9.4 cm3
        (Capsule(0.01, 0.02), Cylinder(0.01, 0.034), "failed"),  # 10.7 cm3
        (MESH, Sphere(0.02), "not observable"),
    ],
)
def test_half_of_the_volume_is_that_of_the_shapes_and_not_of_boxes_around_them(
    inside, outside, status
):
    shapes = Shape(inside), Shape(outside, SE3.from_xyz_rpy((0, 0, 0.3)))
    record, poses = a_bin()
    objects = replace(BOX, shapes=shapes), record
    run = make_run(objects=objects, object_poses={"bin": poses, "box": at(200, (0, 0, 0.03))})
    assert verdict(run, In(object="box", container="bin")).status == status


def test_what_was_in_all_along_is_warned_of_and_what_came_in_is_not():
    record, poses = a_bin()
    for x, names in ((0.0, ["already true at the start"]), (0.15, [])):
        box = at(200, (0, 0, 0.03))
        box[:50, 0] = x
        run = make_run(objects=(BOX, record), object_poses={"bin": poses, "box": box})
        answer = verdict(run, In(object="box", container="bin"))
        assert answer.status == "passed"
        assert [warning.name for warning in answer.warnings] == names


def test_nothing_is_in_a_container_that_has_tipped_over():
    spec = In(object="box", container="bin")
    assert verdict(in_bin(lean=np.radians(44), box=(0, 0, 0.05)), spec).status == "passed"
    answer = verdict(in_bin(lean=np.radians(46), box=(0, 0, 0.05)), spec)
    assert (answer.status, answer.unit) == ("failed", "rad")
    assert answer.margin == pytest.approx(-np.radians(1))


def test_being_in_needs_both_and_a_container_with_a_known_extent():
    record, poses = a_bin()
    gone = make_run(objects=(BOX, record), object_poses={"bin": poses, "box": ABSENT})
    assert verdict(gone, In(object="box", container="bin")).status == "not observable"
    away = replace(gone, objects=(replace(BOX, present=()), record))
    assert verdict(away, In(object="box", container="bin")).status == "not reached"
    floor = replace(record, shapes=(Shape(Plane()),))
    run = make_run(objects=(BOX, floor), object_poses={"bin": poses})
    assert verdict(run, In(object="box", container="bin")).status == "not observable"


def boxes(rng, count=3):
    """A container of tilted boxes between two specks far away that make its outline."""
    tilted = [
        Shape(
            Box(tuple(rng.uniform(0.02, 0.3, 3))),
            SE3.from_xyz_rpy(rng.uniform(-0.2, 0.2, 3), rng.uniform(-3, 3, 3)),
        )
        for _ in range(count)
    ]
    specks = [Shape(Box((1e-4,) * 3), SE3.from_xyz_rpy((far,) * 3)) for far in (-1.0, 1.0)]
    return replace(thing("bin", static=True), shapes=(*tilted, *specks))


def is_met(record, point, way):
    """Whether a box of the container is met on the way from a point, by going there in steps."""
    path = point + np.arange(0, 0.8, 0.0005)[:, None] * np.array(way)
    for shape in record.shapes:
        local = (path - shape.pose.translation) @ shape.pose.rotation
        if (np.abs(local) <= np.array(shape.geometry.size) / 2).all(axis=1).any():
            return True
    return False


@pytest.mark.parametrize("seed", range(6))
def test_a_shape_is_under_an_object_or_on_all_four_sides_of_it(seed):
    rng = np.random.default_rng(seed)
    record = boxes(rng)
    points = rng.uniform(-0.3, 0.3, (60, 3))
    box = at(60, points)
    run = make_run(60, objects=(BOX, record), object_poses={"bin": at(60), "box": box})
    holds = In(object="box", container="bin").margins(Window(run, 0, 60)).values >= 0
    sides = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
    expected = [
        is_met(record, point, (0, 0, -1)) or all(is_met(record, point, way) for way in sides)
        for point in points
    ]
    assert holds.tolist() == expected
    assert 0 < sum(expected) < 60


@pytest.mark.parametrize("geometry", GEOMETRIES, ids=lambda geometry: type(geometry).__name__)
@pytest.mark.parametrize("seed", range(3))
def test_the_outline_of_a_container_is_that_of_its_surface(geometry, seed):
    rng = np.random.default_rng(seed)
    on_body = SE3.from_xyz_rpy(rng.uniform(-0.2, 0.2, 3), rng.uniform(-3, 3, 3))
    points = surface_of(geometry, rng) @ on_body.rotation.T + on_body.translation
    lower, upper = outline(replace(BOX, shapes=(Shape(geometry, on_body),)))
    assert lower == pytest.approx(points.min(axis=0), abs=4e-4)
    assert upper == pytest.approx(points.max(axis=0), abs=4e-4)


def test_what_lies_under_a_table_is_not_in_it():
    table = replace(
        thing("bin", static=True),
        shapes=tuple(
            Shape(Box(size), SE3.from_xyz_rpy(place))
            for size, place in (
                ((0.4, 0.4, 0.02), (0, 0, 0.3)),
                ((0.02, 0.02, 0.29), (0.19, 0.19, 0.145)),
            )
        ),
    )
    poses = {"bin": at(200), "box": at(200, (0.0, 0.0, 0.02))}
    run = make_run(objects=(BOX, table), object_poses=poses)
    answer = verdict(run, In(object="box", container="bin"))
    assert (answer.status, answer.unit) == ("failed", "1")
    assert "inside the outline of bin, which is neither under it nor around it" in answer.reason


EVIDENCE = Evidence(
    three_runs=(
        Three(
            In(object="box", container="bin"),
            shared.in_bin(0.0),
            shared.in_bin(0.0205),
            -0.0005,
            "m",
        ),
    ),
    mutation_cases=((In(object="box", container="bin"), shared.IN_BIN, "late"),),
    picture=(
        ("cup", "{object: ball, container: cup}"),
        ("tipping cup", "{object: ball, container: cup}"),
    ),
    free_shifts=(
        Free(
            "a container that turns about its opening's axis stays upright",
            "in",
            "object_poses bin",
            "+-yaw",
        ),
        Free(
            "its origin is what is in something", "in", "object_poses box", "+-roll +-pitch +-yaw"
        ),
    ),
)
