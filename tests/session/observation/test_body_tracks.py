"""Where bodies stand along a run, and how far their points move, against scipy and sampling."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.core.geometry import Box, Cylinder, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.session.observation.body_tracks import (
    BodyTrack,
    MovingBody,
    carried_track,
    centers_of,
    links_with_shapes,
    object_track,
    relative_track,
    track_of_poses,
    tracked_shapes,
    travels,
)
from harness.session.observation.nearest import (
    largest_travel,
    pairs_between,
    smallest_distances,
)
from tests.judging.synthetic_run import BOX, attachment

N = 50


def random_poses(seed, count=N, step=0.02):
    """A body that wanders and turns, shape (count, 7)."""
    rng = np.random.default_rng(seed)
    places = np.cumsum(rng.normal(scale=step, size=(count, 3)), axis=0)
    turns = Rotation.from_rotvec(np.cumsum(rng.normal(scale=2 * step, size=(count, 3)), axis=0))
    return np.hstack([places, turns.as_quat()[:, [3, 0, 1, 2]]])


def applied(track, point):
    """A point of a body in the world, shape (N, 3)."""
    return track.translations + track.rotations @ np.asarray(point, dtype=float)


def test_a_half_turn_that_rounding_makes_a_little_more_is_a_half_turn():
    beyond = np.diag([1.0, -1 - 1e-9, -1 - 1e-9])
    track = BodyTrack(np.stack([np.eye(3), beyond]), np.zeros((2, 3)))
    assert track.turns == pytest.approx([np.pi])


@pytest.mark.parametrize("seed", range(3))
def test_tracks_are_those_of_the_poses(seed):
    poses = random_poses(seed)
    track = track_of_poses(poses)
    turns = Rotation.from_quat(poses[:, [4, 5, 6, 3]])
    assert track.rotations == pytest.approx(turns.as_matrix())
    assert track.translations.tolist() == poses[:, :3].tolist()
    between = (turns[:-1].inv() * turns[1:]).magnitude()
    assert track.turns == pytest.approx(between, abs=1e-7)
    assert track.present.all()
    missing = poses.copy()
    missing[3] = np.nan
    assert np.flatnonzero(~track_of_poses(missing).present).tolist() == [3]
    part = track.part(np.arange(N) >= 40)
    assert part.translations.tolist() == poses[40:, :3].tolist()
    assert part.rotations.tolist() == track.rotations[40:].tolist()
    half = np.array([[0, 0, 0, 1.0, 0, 0, 0], [0, 0, 0, 0, 0, 1.0, 0]])
    assert track_of_poses(half).turns == pytest.approx([np.pi])


def test_relative_and_carried_tracks_move_points_as_their_bodies_do():
    first, second = track_of_poses(random_poses(1)), track_of_poses(random_poses(2))
    point = (0.1, -0.2, 0.3)
    assert applied(relative_track(first, second), point) == pytest.approx(
        np.einsum("nji,nj->ni", second.rotations, applied(first, point) - second.translations)
    )
    pose = SE3.from_xyz_rpy((0.3, 0.1, -0.2), (0.4, 0.5, 0.6))
    carried = carried_track(first, pose.as_vector())
    assert applied(carried, point) == pytest.approx(
        applied(first, pose.apply(np.array([point]))[0])
    )


def test_what_the_planner_alone_knows_stays_where_it_is_put_and_moves_with_its_link():
    link = track_of_poses(random_poses(3))
    other = track_of_poses(random_poses(4))
    links = SimpleNamespace(
        rotations={"palm": link.rotations, "arm": other.rotations},
        translations={"palm": link.translations, "arm": other.translations},
    )
    start = SE3.from_xyz_rpy((1, 2, 3), (0.1, 0.2, 0.3))
    in_link = SE3.from_xyz_rpy((0.1, 0, 0))
    record = replace(BOX, name="belief", pose=tuple(start.as_vector()), present=((0.05, 0.4),))
    motion = SimpleNamespace(times=np.arange(N) * 0.01, object_poses={})
    held = (
        attachment("belief", 30, 35, pose=in_link, link="arm"),
        attachment("other", 0, 49, pose=in_link),
        attachment("belief", 10, 20, pose=in_link),
    )
    track = object_track(record, held, motion, links)
    assert np.flatnonzero(track.present).tolist() == list(range(5, 41))
    assert track.translations[5:10].tolist() == [[1, 2, 3]] * 5
    assert track.rotations[7] == pytest.approx(start.rotation)
    grip, second = (carried_track(each, in_link.as_vector()) for each in (link, other))
    assert track.translations[10:21] == pytest.approx(grip.translations[10:21])
    assert track.translations[21:30] == pytest.approx(np.tile(grip.translations[20], (9, 1)))
    assert track.rotations[25] == pytest.approx(grip.rotations[20])
    assert track.translations[30:36] == pytest.approx(second.translations[30:36])
    assert track.translations[40] == pytest.approx(second.translations[35])
    assert track.rotations[36:] == pytest.approx(np.tile(second.rotations[35], (14, 1, 1)))
    nowhere = object_track(replace(record, pose=()), held[:2], motion, links)
    assert np.flatnonzero(nowhere.present).tolist() == list(range(30, 41))
    late = object_track(record, (attachment("belief", 60, 70),), motion, links)
    assert late.translations[39].tolist() == [1, 2, 3]
    poses = random_poses(5)
    physical = SimpleNamespace(times=motion.times, object_poses={"belief": poses})
    seen = object_track(record, held, physical, links)
    assert seen.translations[5:41].tolist() == poses[5:41, :3].tolist()
    assert np.flatnonzero(seen.present).tolist() == list(range(5, 41))


SHAPES = (
    Shape(Box((0.1, 0.2, 0.3)), SE3.from_xyz_rpy((0.2, 0, 0.1), (0.3, 0.4, 0.5))),
    Shape(Sphere(0.05), SE3.from_xyz_rpy((-0.1, 0.3, 0))),
    Shape(Cylinder(0.04, 0.3), SE3.from_xyz_rpy((0, 0.1, -0.2), (1.0, 0, 0))),
)


def test_no_point_of_a_shape_moves_further_than_its_bound():
    seen = track_of_poses(random_poses(6))
    tracked = tracked_shapes("body", SHAPES)
    centers = centers_of(seen, tracked)
    radii = np.array([shape.radius for shape in tracked])
    bound = travels(seen, centers, radii)
    assert bound.shape == (N, 3)
    assert not bound[0].any()
    for column, shape in enumerate(tracked):
        assert centers[:, :, column] == pytest.approx(applied(seen, shape.center))
        middle = np.linalg.norm(np.diff(centers[:, :, column], axis=0), axis=1)
        expected = np.concatenate([[0], np.cumsum(middle + radii[column] * seen.turns)])
        assert bound[:, column] == pytest.approx(expected)
        for side in np.vstack([np.eye(3), -np.eye(3)]) * radii[column]:
            path = np.linalg.norm(np.diff(applied(seen, shape.center + side), axis=0), axis=1)
            assert (np.diff(bound[:, column]) >= path - 1e-9).all()


def test_the_gap_is_that_to_the_box_about_a_shape():
    (box, ball, _) = tracked_shapes("body", SHAPES)
    for shape, half, place in (
        (box, np.array([0.05, 0.1, 0.15]), SHAPES[0].pose),
        (ball, np.full(3, 0.05), SHAPES[1].pose),
    ):
        rng = np.random.default_rng(8)
        own = rng.uniform(-0.4, 0.4, (30, 3))
        expected = np.linalg.norm(own - np.clip(own, -half, half), axis=1)
        assert shape.gap(place.apply(own)[:, :, None])[:, 0] == pytest.approx(expected)
        assert np.linalg.norm(shape.center - place.translation) == pytest.approx(0, abs=1e-9)
    assert box.radius == pytest.approx(np.linalg.norm([0.05, 0.1, 0.15]))
    assert list(links_with_shapes({"a": SHAPES, "b": ()})) == ["a"]


def pairs(seed, step, apart=0.5, cutoff=np.inf):
    poses = random_poses(seed, 120, step)
    poses[:, 0] += apart
    seen = track_of_poses(poses)
    first = MovingBody(tracked_shapes("a", SHAPES), seen)
    return pairs_between([first], standing(tracked_shapes("b", SHAPES[::-1]), 120), cutoff)


def standing(shapes, count):
    """A body at the origin."""
    return MovingBody(shapes, BodyTrack(np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))))


@pytest.mark.parametrize(("seed", "step"), [(1, 0.02), (2, 0.002), (3, 0.05), (4, 0.0)])
@pytest.mark.parametrize("cutoff", [0.05, 0.3, 3.0])
def test_the_smallest_of_all_distances_is_found_up_to_the_cutoff(seed, step, cutoff):
    found = pairs(seed, step)
    every = np.array([[pair.distance(k) for pair in found] for k in range(120)])
    distances, which = smallest_distances(found, cutoff, 120)
    assert distances == pytest.approx(np.minimum(every.min(axis=1), cutoff), abs=2e-6)
    assert (which >= 0).tolist() == (distances < cutoff).tolist()
    assert (which[distances >= cutoff] == -1).all()
    rows = np.flatnonzero(which >= 0)
    assert every[rows, which[rows]] == pytest.approx(distances[rows], abs=2e-6)
    for index, pair in enumerate(found):
        assert (pair.least <= every[:, index] + 1e-9).all()
        assert pair.least.max() > every[:, index].min() - 1.0


@pytest.mark.parametrize(("seed", "step"), [(2, 0.002), (4, 0.0)])
def test_pairs_that_stay_apart_are_left_out_without_effect(seed, step):
    every, near = pairs(seed, step), pairs(seed, step, cutoff=0.3)
    assert 0 < len(near) < len(every)
    found, rest = (smallest_distances(each, 0.3, 120) for each in (every, near))
    assert found[0].tolist() == rest[0].tolist()
    travels_of = [largest_travel(each, 0.3, 120).tolist() for each in (every, near)]
    assert travels_of[0] == travels_of[1]
    for index, other in zip(found[1].tolist(), rest[1].tolist(), strict=True):
        if index >= 0:
            assert (every[index].first.center == near[other].first.center).all()
            assert (every[index].second.center == near[other].second.center).all()
    assert pairs(seed, step, apart=5.0, cutoff=0.3) == []


def test_the_largest_travel_is_that_of_the_pairs_that_may_come_near():
    found = pairs(1, 0.02)
    steps = np.array([np.diff(pair.travel) for pair in found])
    every = largest_travel(found, np.inf, 120)
    assert every.tolist() == [0.0, *steps.max(axis=0).tolist()]
    assert not largest_travel(found, -10.0, 120).any()
    near = [
        pair.least[1:] + pair.least[:-1] - moved < 2 * 0.2
        for pair, moved in zip(found, steps, strict=True)
    ]
    expected = np.where(near, steps, 0.0).max(axis=0)
    assert largest_travel(found, 0.2, 120)[1:] == pytest.approx(expected)


def test_no_point_of_a_body_moves_further_than_its_bound():
    body = MovingBody(tracked_shapes("body", SHAPES), track_of_poses(random_poses(7)))
    for shape in body.shapes:
        for side in np.vstack([np.eye(3), -np.eye(3)]) * shape.radius:
            places = applied(body.track, shape.center + side)
            path = np.linalg.norm(np.diff(places, axis=0), axis=1)
            assert (np.diff(body.travelled) >= path - 1e-9).all()


def test_nothing_is_too_far_from_a_half_space_to_be_measured():
    floor = standing(tracked_shapes("floor", (Shape(Plane()),)), 40)
    poses = random_poses(9, 40, 0.01)
    poses[:, 2] += 0.3
    ball = track_of_poses(poses)
    [pair] = pairs_between([MovingBody(tracked_shapes("ball", SHAPES[1:2]), ball)], floor, 1.0)
    distances, _ = smallest_distances([pair], 1.0, 40)
    heights = applied(ball, pair.first.center)[:, 2]
    assert distances == pytest.approx(heights - 0.05, abs=2e-6)


@pytest.mark.parametrize("length", [40, 1200])
def test_a_body_that_comes_near_while_the_nearest_one_stands_still_is_found(length):
    """One ball stands 10 cm away; another passes at 5 cm, first or last of the two."""
    ball = tracked_shapes("ball", (Shape(Sphere(0.01)),))
    still, passing = np.zeros((length, 7)), np.zeros((length, 7))
    still[:, 3] = passing[:, 3] = 1.0
    still[:, 0], passing[:, 1] = 0.12, 0.07
    passing[:, 0] = np.linspace(-1.0, 1.0, length)
    found = [
        pairs_between([MovingBody(ball, track_of_poses(poses))], standing(ball, length))[0]
        for poses in (still, passing)
    ]
    expected = np.minimum(0.1, np.linalg.norm(passing[:, :3], axis=1) - 0.02)
    for order in (found, found[::-1]):
        distances, which = smallest_distances(order, 1.0, length)
        assert distances == pytest.approx(expected, abs=2e-6)
        near = distances < 0.1 - 1e-5
        assert {order[index] is found[1] for index in which[near].tolist()} == {True}
        assert near.any()


def test_stretches_of_samples_far_apart_leave_the_same_pairs_as_each_alone():
    """A jump between two stretches brings no pair nearer."""
    poses = random_poses(5, 120, 0.002)
    poses[:, 0] += 0.5
    poses[60:, 0] += 3.0
    shapes, others = tracked_shapes("a", SHAPES), tracked_shapes("b", SHAPES[::-1])
    alone = [
        pairs_between([MovingBody(shapes, track_of_poses(part))], standing(others, 60), 0.4)
        for part in (poses[:60], poses[60:])
    ]
    assert alone[0]
    assert not alone[1]
    stretches = np.repeat([0, 1], 60)
    body = standing(others, 120)
    both = pairs_between(
        [MovingBody(shapes, track_of_poses(poses), stretches)],
        MovingBody(others, body.track, stretches),
        0.4,
    )
    assert [(pair.first, pair.second) for pair in both] == [
        (pair.first, pair.second) for pair in alone[0]
    ]
    apart, joined = smallest_distances(alone[0], 0.4, 60), smallest_distances(both, 0.4, 120)
    assert joined[0].tolist() == pytest.approx([*apart[0], *[0.4] * 60], abs=2e-6)
