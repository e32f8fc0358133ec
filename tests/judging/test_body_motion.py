"""How far bodies moved and how fast, by their points; what a step puts somewhere does not move."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from harness.core.spatial import SE3
from harness.judging.body_motion import balls_of, body_speeds, middle_of
from tests.judging.synthetic_run import BOX, DT, at, make_run, thing
from tests.session.front_door import failures, run

N = 40


def shaped(*shapes):
    """A run with one object, `body`, of some shapes."""
    return make_run(N, objects=(replace(thing("body"), shapes=shapes),))


@pytest.mark.parametrize("geometry", [Box((0.2, 0.1, 0.06)), Cylinder(0.05, 0.3), Sphere(0.1),
                                      Capsule(0.04, 0.2)])  # fmt: skip
def test_no_point_of_a_shape_moves_further_than_its_balls(geometry):
    rng = np.random.default_rng(7)
    place = SE3.from_xyz_rpy((0.3, -0.2, 0.1), (0.4, 0.5, -0.6))
    balls = balls_of(shaped(Shape(geometry, place)).objects[0])
    first = np.append(rng.normal(size=3), SE3.from_xyz_rpy(rpy=rng.normal(size=3)).quat_wxyz)
    second = np.append(rng.normal(size=3), SE3.from_xyz_rpy(rpy=rng.normal(size=3)).quat_wxyz)
    moved = balls.moved(first, second[None])[0]
    points = place.apply(surface(geometry, rng))
    ways = SE3.from_vector(second).apply(points) - SE3.from_vector(first).apply(points)
    furthest = np.linalg.norm(ways, axis=1).max()
    assert furthest <= moved + 1e-12
    assert moved < furthest + (1e-12 if isinstance(geometry, Box) else 0.2)


def surface(geometry, rng):
    """Points on a shape, the corners of a box among them, shape (k, 3)."""
    ways = rng.normal(size=(500, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    match geometry:
        case Box(size=size):
            return np.sign(ways) * np.array(size) / 2
        case Sphere(radius=radius):
            return ways * radius
        case Cylinder(radius=radius, length=length):
            rim = ways[:, :2] / np.linalg.norm(ways[:, :2], axis=1, keepdims=True)
            return np.column_stack([rim * radius, np.sign(ways[:, 2]) * length / 2])
        case Capsule(radius=radius, length=length):
            return ways * radius + np.sign(ways[:, 2:]) * (0, 0, length / 2)


def test_the_middle_is_the_centre_of_mass_or_that_of_the_shapes():
    shapes = tuple(Shape(Sphere(0.1), SE3.from_xyz_rpy((x, 0, 0))) for x in (1.0, 2.0))
    assert middle_of(replace(BOX, shapes=shapes)).tolist() == [1.5, 0, 0]
    assert middle_of(replace(BOX, shapes=())).tolist() == [0, 0, 0]
    heavy = replace(BOX, shapes=shapes, center_of_mass=(0.5, 0.25, 0.125))
    assert middle_of(heavy).tolist() == [0.5, 0.25, 0.125]
    mesh = replace(heavy, shapes=(Shape(Mesh("a.stl", np.ones(3))),))
    balls = balls_of(mesh)
    assert (balls.centers.tolist(), balls.radii.tolist()) == ([[0.5, 0.25, 0.125]], [0.0])


def test_a_bar_that_turns_about_its_middle_is_as_fast_as_its_ends():
    bar = shaped(Shape(Box((0.5, 0.0, 0.0))))
    poses = at(N)
    for row in range(N):
        poses[row, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 0.01 * row)).quat_wxyz
    linear, angular = body_speeds(bar, "body", poses)
    assert angular[10:] == pytest.approx(np.full(N - 10, 0.01 / DT))
    assert linear[10:] == pytest.approx(np.full(N - 10, 2 * 0.25 * np.sin(0.005) / DT))


def test_in_the_first_50_ms_a_speed_is_at_most_what_the_body_has_moved_since():
    """One step of fall until a contact begins is no motion; a fall that goes on is one."""
    poses = at(N)
    poses[1:, 2] = -1e-4
    settles, _ = body_speeds(make_run(N), "box", poses)
    assert settles == pytest.approx([0, 1e-4 / 0.05, *[0] * (N - 2)])
    poses[:, 2] = -4.9 * (DT * np.arange(N)) ** 2
    falls, _ = body_speeds(make_run(N), "box", poses)
    assert falls[5] == pytest.approx(4.9 * 0.05**2 / 0.05)
    assert falls[6:] == pytest.approx(-np.diff(poses[5:, 2]) / DT)
    poses[:, 2] = np.where(np.arange(N) < 20, 0, -1e-4)
    late, _ = body_speeds(make_run(N), "box", poses)
    assert late.max() == pytest.approx(1e-4 / DT), "what moves later moves"


STANDS = """
objects:
  - {name: block, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.6, 0.6, %s]}}
expect:
%s
"""
ANYWHERE = """
  - {always: {static: {object: block, max_velocity: 1 cm/s}}, during: after}
  - formula: always speed(block) < 1
"""


@pytest.mark.parametrize("pose", ["{xyz: [0.6, 0.1, 0.05]}",
                                  "{xyz: [0.6, 0.6, 0.05], rpy: [0, 0, 90 deg]}",
                                  "{xyz: [0.6, -0.6, 0.05], rpy: [90 deg, 0, 0]}"])  # fmt: skip
def test_what_a_step_puts_elsewhere_at_rest_has_no_speed(tmp_path, pose):
    steps = f"""
    - wait: 0.2
    - move_object: {{object: block, pose: {pose}}}
    - {{wait: 0.2, id: after}}
    """
    result, _ = run(tmp_path, steps, robot="ur3e", rest=STANDS % ("0.05", ANYWHERE))
    assert failures(result) == []


def test_what_a_step_lets_fall_is_not_static_after_it(tmp_path):
    steps = """
    - move_object: {object: block, pose: {xyz: [0.6, 0.1, 0.15]}}
    - {wait: 0.2, id: after}
    """
    result, _ = run(tmp_path, steps, robot="ur3e", rest=STANDS % ("0.05", ANYWHERE))
    [failure, other] = failures(result)
    assert "static" in failure
    assert "speed(block)" in other


@pytest.mark.parametrize("height", ["0.05", "0.0501", "0.0499"])
def test_an_object_that_is_put_on_its_support_is_static_from_the_start(tmp_path, height):
    rest = STANDS % (height, "  - always: {static: block}")
    result, _ = run(tmp_path, "- wait: 0.5", robot="ur3e", rest=rest)
    assert failures(result) == []


def test_a_message_names_the_moment_of_the_speed_that_it_states(tmp_path):
    steps = """
    - wait: 0.2
    - inject: {push: {block: [0, 60, 0]}, push_duration: 10 ms}
    - {wait: 1, id: after}
    """
    rest = STANDS % ("0.05", "  - {static: block, during: after, within: 30 ms}")
    result, record = run(tmp_path, steps, robot="ur3e", rest=rest)
    [verdict] = result.verdicts
    speeds = np.linalg.norm(np.diff(record.signals.object_poses["block"][:, :3], axis=0), axis=1)
    sample = int(np.argmin(np.abs(record.signals.times - verdict.time)))
    assert verdict.status == "failed"
    assert verdict.measures[0].value == pytest.approx(speeds[sample - 1] / 0.001, rel=0.1)
    assert f"t={verdict.time:.3f} s" in verdict.reason


def test_nothing_is_near_between_two_places_where_a_step_puts_an_object(tmp_path):
    """The line between the two places goes through the arm; then the block is put inside of it."""
    steps = """
    - wait: 0.1
    - move_object: {object: block, pose: {xyz: [-0.6, -0.6, 0.05]}}
    - {wait: 0.1, id: far}
    - move_object: {object: block, pose: {xyz: [0.2, 0, 0.15]}}
    - {wait: 0.1, id: near}
    """
    lines = """
  - {clearance: {between: [robot, block], at_least: 10 cm}, during: far}
  - {formula: "always distance(robot, block) > 10 cm", during: far}
  - {clearance: {between: [robot, block], at_least: 10 cm}, during: near}
"""
    result, _ = run(tmp_path, steps, robot="ur3e", rest=STANDS % ("0.05", lines))
    assert [verdict.status for verdict in result.verdicts] == ["passed", "passed", "failed"]
