"""What carries an object from below: heights and forces, worked out by hand or by sampling."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Mesh, Shape, Sphere
from harness.core.spatial import SE3
from harness.judging.support import (
    SINKING,
    is_below,
    lowest_points,
    riders,
    standing,
    supports,
)
from tests.judging.surfaces import GEOMETRIES, surface_of
from tests.judging.synthetic_run import BOX, TABLE, at, force, make_run, thing

N = 4


@pytest.mark.parametrize("geometry", GEOMETRIES, ids=lambda geometry: type(geometry).__name__)
@pytest.mark.parametrize("seed", range(4))
def test_the_lowest_point_is_that_of_the_surface(geometry, seed):
    rng = np.random.default_rng(seed)
    on_body = SE3.from_xyz_rpy(rng.uniform(-0.2, 0.2, 3), rng.uniform(-3, 3, 3))
    body = SE3.from_xyz_rpy(rng.uniform(-1, 1, 3), rng.uniform(-3, 3, 3))
    points = surface_of(geometry, rng) @ on_body.rotation.T + on_body.translation
    heights = (points @ body.rotation.T + body.translation)[:, 2]
    record = replace(BOX, shapes=(Shape(geometry, on_body),))
    [lowest] = lowest_points(record, body.as_vector()[None])
    assert lowest == pytest.approx(heights.min(), abs=2e-4)


def test_of_several_shapes_the_lowest_counts_and_of_a_mesh_its_origin():
    high, low = (Shape(Sphere(0.01), SE3.from_xyz_rpy((0, 0, z))) for z in (0.3, -0.2))
    poses = at(N, (0, 0, 1.0))
    assert lowest_points(replace(BOX, shapes=(high, low)), poses) == pytest.approx([0.79] * N)
    mesh = Shape(Mesh("a.stl", np.ones(3)), SE3.from_xyz_rpy((0, 0, 0.1)))
    assert lowest_points(replace(BOX, shapes=(mesh,)), poses) == pytest.approx([1.1] * N)
    assert lowest_points(replace(BOX, shapes=()), poses) == pytest.approx([1.0] * N)


@pytest.mark.parametrize(("off", "is_under"), [(-1e-5, True), (1e-5, False)])
def test_a_support_has_its_centre_below_the_object_or_as_far_above_as_it_may_sink(off, is_under):
    """The table's centre is at -0.015 m; the cube's lowest point is 0.02 m below its origin."""
    height = -0.015 - SINKING + 0.02 - off
    run = make_run(N, object_poses={"box": at(N, (0, 0, height))})
    assert is_below(run, "Table", "box").tolist() == [is_under] * N


def test_one_shape_that_is_low_enough_suffices_and_an_unknown_body_is_not_below():
    high, low = (Shape(Sphere(0.01), SE3.from_xyz_rpy((0.5, 0, z))) for z in (0.9, -0.1))
    shelf = replace(TABLE, shapes=(high, low))
    assert is_below(make_run(N, objects=(shelf, BOX)), "Table", "box").all()
    over = replace(TABLE, shapes=(high,))
    assert not is_below(make_run(N, objects=(over, BOX)), "Table", "box").any()
    assert not is_below(make_run(N), "arm_link", "box").any()
    bare = replace(TABLE, shapes=())
    assert is_below(make_run(N, objects=(bare, BOX)), "Table", "box").all(), "its origin is below"
    raised = {"Table": at(N, (0, 0, 0.1))}
    run = make_run(N, objects=(bare, BOX), object_poses=raised)
    assert not is_below(run, "Table", "box").any()


def test_forces_from_below_count_whichever_of_the_two_is_named_first():
    """Upward on the second of a pair; never more than the whole force, and no pull."""
    whole = force(N, (0, N), value=2.0)
    for pair, sign in ((("Table", "box"), 1.0), (("box", "Table"), -1.0)):
        for upward, expected in ((0.5, 0.5), (5.0, 2.0), (-0.5, 0.0)):
            recorded = {pair: np.full(N, sign * upward)}
            run = make_run(N, contact_forces={pair: whole}, support_forces=recorded)
            assert supports(run, "box")["Table"] == pytest.approx([expected] * N)


def test_without_directions_the_whole_force_of_a_body_below_counts_and_links_never_do():
    forces = {(name, "box"): force(N, (0, N)) for name in ("Table", "arm_link")}
    assert set(supports(make_run(N, contact_forces=forces), "box")) == {"Table"}
    assert supports(make_run(N, contact_forces=forces), "box")["Table"].tolist() == [1.0] * N
    raised = {"Table": at(N, (0, 0, 0.5)), "box": at(N, (0, 0, 0.02))}
    run = make_run(N, contact_forces=forces, object_poses=raised)
    assert supports(run, "box")["Table"].tolist() == [0.0] * N


def test_an_object_rides_on_another_while_it_touches_nothing_else():
    cup = thing("cup")
    poses = {"cup": at(N, (0, 0, 0.06)), "box": at(N, (0, 0, 0.02))}
    forces = {("box", "cup"): force(N, (0, N)), ("arm_link", "cup"): force(N, (2, N), value=0.002)}
    run = make_run(N, objects=(TABLE, BOX, cup), object_poses=poses, contact_forces=forces)
    assert riders(run, "box")["cup"].tolist() == [True, True, False, False]
    assert not riders(run, "cup")["box"].any()
    assert "Table" not in riders(run, "box"), "what is fixed rides on nothing"
    light = {**forces, ("arm_link", "cup"): force(N, (2, N), value=0.001)}
    run = make_run(N, objects=(TABLE, BOX, cup), object_poses=poses, contact_forces=light)
    assert riders(run, "box")["cup"].all()


@pytest.mark.parametrize(
    ("upward", "rides"), [(1.0, True), (0.002, True), (0.0, False), (-1.0, False)]
)
@pytest.mark.parametrize("height", [0.0, 0.06], ids=["around it", "above it"])
def test_what_hangs_on_another_rides_as_it_pushes_it_up(upward, rides, height):
    """A hoop reaches below the rod that carries it; a board that leans on it does not ride."""
    hoop, poses = thing("hoop"), {"hoop": at(N, (0, 0, height)), "box": at(N, (0, 0, 0.02))}
    pair = ("box", "hoop")
    run = make_run(
        N,
        objects=(TABLE, BOX, hoop),
        object_poses=poses,
        contact_forces={pair: force(N, (0, N))},
        support_forces={pair: np.full(N, upward)},
    )
    assert riders(run, "box")["hoop"].all() == riders(run, "box")["hoop"].any() == rides


def stacked(*touching):
    """Cup and lid on the box, each 4 cm high, and what else touches, all with 1 N of weight."""
    objects = (TABLE, BOX, thing("cup"), thing("lid"))
    poses = {name: at(N, (0, 0, 0.02 + 0.04 * k)) for k, name in enumerate(("box", "cup", "lid"))}
    pairs = (("box", "cup"), ("cup", "lid"), *touching)
    forces = {
        pair: force(N, (0, N), value=2.0 if pair == ("box", "cup") else 1.0) for pair in pairs
    }
    return make_run(N, objects=objects, object_poses=poses, contact_forces=forces)


def test_a_stack_rides_as_long_as_none_of_it_touches_anything_else():
    assert {name: rides.all() for name, rides in riders(stacked(), "box").items()} == {
        "cup": True,
        "lid": True,
    }
    assert not riders(stacked(), "cup")["box"].any(), "what carries rides on nothing"
    leaning = riders(stacked(("Table", "lid")), "box")
    assert not any(rides.any() for rides in leaning.values())
    assert riders(stacked(("palm", "lid")), "box")["cup"].all(), "the hand may touch it"


@pytest.mark.parametrize(
    ("below", "stands"), [("Table", True), ("arm_link", False), ("base_link", True)]
)
def test_a_stack_stands_where_its_lowest_body_does(below, stands):
    """On something fixed, also on a link that never moves, but not on a moving link."""
    run = stacked((below, "box"))
    forces = {**run.signals.contact_forces, (below, "box"): force(N, (0, N), value=3.0)}
    presses = {(below, "box"): np.tile([0, 0, 0, 0, 0, 3.0], (N, 1))} if below != "Table" else {}
    run = replace(run, signals=replace(run.signals, contact_forces=forces, presses=presses))
    assert standing(run, "lid")["cup"].tolist() == [1.0 if stands else 0.0] * N
    assert supports(run, "lid")["cup"].tolist() == [1.0] * N


def test_no_support_lasts_longer_than_its_last_contact():
    forces = {("Table", "box"): force(N, (0, 2))}
    assert supports(make_run(N, contact_forces=forces), "box")["Table"].tolist() == [1, 1, 0, 0]
