"""Objects of meshes are judged by their convex hulls, as others are by their shapes."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from harness.core.antipodal import least_thickness
from harness.core.geometry import Box, Hull, Mesh, Shape, bounding_radius, bounds_of
from harness.core.solids import volume_of
from harness.core.spatial import SE3
from harness.judging.body_motion import balls_of, lowest_points, middle_of
from harness.judging.contacts import unseen_contacts
from harness.plugins.objects.expectations.in_ import In
from harness.recording.consistency import run_flaws
from harness.recording.plain import from_plain, to_plain
from harness.recording.run import ObjectRecord
from harness.robot.collision_shapes import collision_shapes
from harness.robot.mesh_file import with_hull
from tests.judging.synthetic_run import BOX, at, make_run, thing, verdict

N = 40
SIZE = (0.5, 0.02, 0.04)
PLACE = SE3.from_xyz_rpy((0.1, -0.2, 0.3), (0.3, -0.5, 0.7))


def mesh_shapes(folder, solid, collision="hull", place=None):
    """The shapes of an object of a mesh file, as a world has them."""
    path = folder / "part.stl"
    solid.export(path)
    whole = Shape(Mesh(path, (1.0, 1.0, 1.0), collision), place or SE3.identity())
    return tuple(map(with_hull, collision_shapes([whole])))


@pytest.mark.parametrize("shift", [(0, 0, 0), (0.3, -0.1, 0.2)], ids=["centred", "off its origin"])
def test_a_mesh_of_a_box_is_measured_as_the_box(tmp_path, shift):
    solid = trimesh.creation.box(SIZE)
    solid.apply_translation(shift)
    [shape] = mesh_shapes(tmp_path, solid, place=PLACE)
    box = Shape(Box(SIZE), PLACE @ SE3.from_xyz_rpy(shift))
    mesh, same = replace(BOX, shapes=(shape,)), replace(BOX, shapes=(box,))
    poses = at(N, (0, 0, 1.0))
    for row in range(N):
        poses[row, 3:] = SE3.from_xyz_rpy(rpy=(0.1 * row, 0.2 * row, 0)).quat_wxyz
    assert lowest_points(mesh, poses) == pytest.approx(lowest_points(same, poses), abs=1e-7)
    assert np.allclose(bounds_of(mesh.shapes), bounds_of(same.shapes), atol=1e-7)
    assert middle_of(replace(mesh, center_of_mass=())) == pytest.approx(box.pose.translation)
    assert volume_of(shape.geometry) == pytest.approx(np.prod(SIZE), rel=1e-6)
    assert least_thickness(mesh.shapes) == pytest.approx(0.02)
    assert bounding_radius(shape) <= bounding_radius(box) + 1e-7
    moved = balls_of(mesh).moved(poses[:-1], poses[1:])
    assert (moved >= balls_of(same).moved(poses[:-1], poses[1:]) - 1e-7).all()


def test_without_a_turn_a_mesh_moves_as_far_as_its_frame(tmp_path):
    shapes = mesh_shapes(tmp_path, trimesh.creation.icosphere(subdivisions=3, radius=0.05))
    poses = at(N)
    poses[:, 0] = 0.01 * np.arange(N)
    assert balls_of(replace(BOX, shapes=shapes)).moved(poses[:-1], poses[1:]) == pytest.approx(0.01)


@pytest.mark.parametrize(("turn", "is_missed"), [(0.21, True), (0.15, False)])
def test_a_bar_of_a_mesh_may_pass_through_something_as_a_box_may(tmp_path, turn, is_missed):
    """Its ends move by 52 and by 37 mm at once; bar and box are 1 and 4 cm thick."""
    bar = thing("bar", Box((1, 1, 1)))
    bar = replace(bar, shapes=mesh_shapes(tmp_path, trimesh.creation.box((0.5, 0.01, 0.01))))
    poses = at(N)
    for row in range(N):
        poses[row, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, turn * row)).quat_wxyz
    run = make_run(N, objects=(BOX, bar), object_poses={"bar": poses})
    assert bool(unseen_contacts(run, [("bar", "box")])) == is_missed


@pytest.mark.nightly
def test_the_triangles_of_a_mesh_have_no_thickness_and_enclose_what_is_not_recorded(tmp_path):
    shapes = mesh_shapes(tmp_path, cup(), collision="exact")
    assert least_thickness(shapes) == 0.0
    record = replace(thing("bin", static=True), shapes=shapes)
    run = make_run(N, objects=(BOX, record), object_poses={"bin": at(N), "box": at(N)})
    assert verdict(run, In(object="box", container="bin")).status == "not observable"


def cup():
    """An open box of 20 x 20 x 20 cm with walls of 2 cm."""
    walls = [
        trimesh.creation.box((0.02, 0.2, 0.2), SE3.from_xyz_rpy((x, 0, 0)).matrix())
        for x in (-0.09, 0.09)
    ]
    walls += [
        trimesh.creation.box((0.16, 0.02, 0.2), SE3.from_xyz_rpy((0, y, 0)).matrix())
        for y in (-0.09, 0.09)
    ]
    floor = trimesh.creation.box((0.16, 0.16, 0.02), SE3.from_xyz_rpy((0, 0, -0.09)).matrix())
    return trimesh.util.concatenate([*walls, floor])


@pytest.mark.parametrize(
    ("place", "turned", "status"),
    [
        ((0, 0, 0), 0.0, "passed"),
        ((0.13, 0, 0), 0.0, "failed"),
        ((0, 0, -0.13), 0.0, "failed"),
        ((0, 0, -0.05), np.pi, "failed"),
    ],
    ids=["in it", "next to it", "below it", "under the one that stands on its rim"],
)
def test_what_is_in_a_container_of_a_mesh(tmp_path, place, turned, status):
    shapes = mesh_shapes(tmp_path, cup(), collision="parts")
    assert len(shapes) > 3
    record = replace(thing("bin", static=True), shapes=shapes)
    quat = SE3.from_xyz_rpy(rpy=(turned, 0, 0)).quat_wxyz
    run = make_run(
        N, objects=(BOX, record), object_poses={"bin": at(N, (0, 0, 0), quat), "box": at(N, place)}
    )
    assert verdict(run, In(object="box", container="bin")).status == status


@pytest.mark.parametrize(("side", "status"), [(0.035, "passed"), (0.045, "failed")])
def test_half_of_the_volume_counts_where_a_mesh_is_next_to_a_box(tmp_path, side, status):
    """The mesh inside has 64 cm3, the box outside 43 and 91 cm3."""
    inside = mesh_shapes(tmp_path, trimesh.creation.box((0.04, 0.04, 0.04)))
    outside = Shape(Box((side,) * 3), SE3.from_xyz_rpy((0, 0, 0.5)))
    content = replace(BOX, shapes=(*inside, outside))
    record = replace(thing("bin", Box((0.2, 0.2, 0.2)), static=True))
    run = make_run(N, objects=(content, record), object_poses={"bin": at(N), "box": at(N)})
    assert verdict(run, In(object="box", container="bin")).status == status


def test_a_saved_record_has_the_hulls_and_damaged_ones_are_refused(tmp_path):
    record = replace(BOX, shapes=mesh_shapes(tmp_path, trimesh.creation.box(SIZE)))
    [shape] = from_plain(to_plain(record), ObjectRecord).shapes
    assert shape.geometry.hull == record.shapes[0].geometry.hull
    assert not [*run_flaws(make_run(N, objects=(record,)))]
    hull = shape.geometry.hull
    for damaged in (
        replace(hull, corners=()),
        replace(hull, corners=((0.0, np.nan, 0.0),)),
        replace(hull, volume=0.0),
        Hull(hull.corners, np.inf, hull.centroid, 1.0),
    ):
        other = replace(shape, geometry=replace(shape.geometry, hull=damaged))
        flaws = [*run_flaws(make_run(N, objects=(replace(record, shapes=(other,)),)))]
        assert [key for key, _ in flaws] == ["objects[0].shapes[0].geometry.hull"]
