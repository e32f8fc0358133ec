"""Meshes as convex parts: what they cover, how they are kept, and which meshes need them."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import coal
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from harness.core.errors import RobotError
from harness.core.geometry import Mesh, Shape, undivided
from harness.core.user_cache import cache_folder
from harness.language.scenario import RobotSpec
from harness.plugins.authoring.robot_check import check_robot
from harness.plugins.meshes.decomposition import MOST_PARTS, decompose
from harness.plugins.meshes.solid_grid import surface_points
from harness.robot.collision_shapes import collision_shapes
from harness.robot.convex_parts import stored_decomposition
from harness.robot.load import load_robot
from harness.robot.mesh_file import (
    decomposition_of,
    exact_surface,
    hull_points,
    read_triangles,
)
from tests.robot.arm_files import SHAPE, SRDF, URDF
from tests.robot.vessels import vessel, write_obj

BIN = {"sides": 4, "outer": 0.1, "inner": 0.09, "height": 0.06, "floor": 0.005}
CUP = {"sides": 16}


@pytest.fixture(scope="module", autouse=True)
def kept(tmp_path_factory):
    """A cache of this module's own."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder


def broken(vertices, faces):
    """Without every ninth triangle."""
    return vertices, np.delete(faces, slice(None, None, 9), axis=0)


def open_sheet(vertices, faces):
    """The outer wall and the floor alone, which enclose nothing."""
    return vertices, faces[[*range(8), *range(-7, 0, 2)]]


def is_in(parts, points):
    inside = np.zeros(len(points), dtype=bool)
    for part in parts:
        faces = ConvexHull(part).equations
        inside |= (points @ faces[:, :3].T + faces[:, 3] <= 1e-9).all(axis=1)
    return inside


VESSELS = {
    "bin": vessel(**BIN),
    "six sides": vessel(**BIN | {"sides": 6, "inner": 0.094}),
    "cup": vessel(**CUP),
    "broken": broken(*vessel(**BIN | {"sides": 3})),
    "open": open_sheet(*vessel(**BIN)),
}


@cache
def decomposed(name):
    vertices, faces = VESSELS[name]
    return decompose(vertices[faces])


@pytest.mark.nightly
@pytest.mark.parametrize("name", VESSELS)
def test_the_parts_hold_the_whole_surface_and_stay_as_near_to_it_as_they_say(name, tmp_path):
    vertices, faces = VESSELS[name]
    found = decomposed(name)
    assert 1 < len(found.parts) <= MOST_PARTS
    assert found.excess < 0.01 < found.hull_excess
    assert is_in(found.parts, surface_points(vertices[faces], 0.004)).all()
    surface = exact_surface(Mesh(write_obj(tmp_path / "mesh.obj", vertices, faces)))
    low, high = vertices.min(axis=0) - 0.001, vertices.max(axis=0) + 0.001
    points = np.random.default_rng(0).uniform(low, high, (3000, 3))
    dot, result = coal.Sphere(1e-9), coal.DistanceResult()
    for point in points[is_in(found.parts, points)]:
        result.clear()
        place = coal.Transform3s(np.eye(3), point)
        coal.distance(surface, coal.Transform3s(), dot, place, coal.DistanceRequest(), result)
        assert result.min_distance <= found.excess


@pytest.mark.nightly
def test_a_bin_is_its_floor_and_its_walls():
    found = decomposed("bin")
    assert len(found.parts) == 5


def test_a_convex_mesh_is_one_part_without_error():
    found = decompose(box_triangles())
    assert (len(found.parts), found.excess, found.hull_excess) == (1, 0.0, 0.0)


@pytest.mark.nightly
def test_corners_that_hardly_stand_out_of_a_fine_mesh_are_left_out():
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.01)
    [part] = decompose(np.asarray(ball.triangles)).parts
    faces = ConvexHull(part).equations
    heights = (np.asarray(ball.vertices) @ faces[:, :3].T + faces[:, 3]).max(axis=1)
    assert len(part) < 0.3 * len(ball.vertices)
    assert heights.max() <= 2e-5


@pytest.mark.nightly
def test_another_process_finds_the_same_parts(tmp_path):
    path = write_obj(tmp_path / "bin.obj", *vessel(**BIN | {"sides": 3}))
    here = decomposition_of(Mesh(path))
    code = (
        "import sys, pathlib; from harness.core.geometry import Mesh;"
        "from harness.robot.mesh_file import decomposition_of;"
        "parts = decomposition_of(Mesh(pathlib.Path(sys.argv[1]))).parts;"
        "sys.stdout.buffer.write(b''.join(part.tobytes() for part in parts))"
    )
    there = subprocess.run(
        [sys.executable, "-c", code, str(path)],
        env=os.environ | {"XDG_CACHE_HOME": str(tmp_path / "empty"), "OMP_NUM_THREADS": "2"},
        capture_output=True,
        check=True,
    )
    assert there.stdout == b"".join(part.tobytes() for part in here.parts)


def test_thin_triangles_have_no_more_points_than_their_length_needs():
    needle = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-4, 0.0]]])
    points = surface_points(needle, 0.001)
    assert len(points) < 1100
    assert np.diff(np.sort(points[:, 0])).max() < 0.0011
    assert {tuple(corner) for corner in needle[0]} <= {tuple(point) for point in points}


@pytest.mark.nightly
def test_a_mesh_whose_parts_are_stored_is_not_read_again(tmp_path):
    path = write_obj(tmp_path / "bin.obj", *vessel(**BIN))
    shapes = collision_shapes([Shape(Mesh(path))])
    other = write_obj(tmp_path / "copy.obj", *vessel(**BIN))
    before = read_triangles.cache_info().misses
    assert len(collision_shapes([Shape(Mesh(other))])) == len(shapes)
    hull_points(Mesh(other))
    assert read_triangles.cache_info().misses == before


def box_triangles():
    corners = np.array([[x, y, z] for x in (0, 0.1) for y in (0, 0.2) for z in (0, 0.3)])
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6),
             (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    return corners[np.array(faces)]


def stored(content=b"box"):
    """What is stored of a box, which is found quickly, and whether it was computed."""
    box = box_triangles()
    computed = []
    triangles = lambda: computed.append(1) or box  # noqa: E731
    found = stored_decomposition(content, np.ones(3), triangles, is_hull=False)
    return found, bool(computed)


def test_parts_are_computed_once_for_the_same_content(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first, was_computed = stored()
    again, is_computed = stored()
    assert (was_computed, is_computed) == (True, False)
    assert [part.tobytes() for part in first.parts] == [part.tobytes() for part in again.parts]
    assert (first.excess, first.hull_excess) == (again.excess, again.hull_excess)
    [file] = (cache_folder() / "convex_parts").iterdir()
    file.write_bytes(file.read_bytes()[:500])
    assert stored()[1], "a damaged file is computed again"
    assert not stored()[1]


def test_writers_at_the_same_time_leave_one_whole_file(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with ThreadPoolExecutor(3) as pool:
        assert len(list(pool.map(lambda _: stored(), range(3)))) == 3
    assert len(list((cache_folder() / "convex_parts").iterdir())) == 1
    assert not stored()[1]


def test_without_a_writable_cache_the_parts_are_computed(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert stored()[1]
    assert stored()[1]


def test_each_mode_gives_its_shapes_and_files_and_pictures_keep_the_mesh(tmp_path):
    path = write_obj(tmp_path / "bin.obj", *vessel(**BIN))
    shape = Shape(Mesh(path))
    parts = collision_shapes([shape])
    assert [each.geometry.part for each in parts] == [0, 1, 2, 3, 4]
    assert [each.geometry.part for each in collision_shapes([shape], "hull")] == [None]
    own = Shape(Mesh(path, collision="exact"))
    assert [each.geometry.collision for each in collision_shapes([own], "hull")] == ["exact"]
    assert collision_shapes(parts) == parts
    assert [each.geometry.part for each in undivided(parts)] == [None]
    assert len(hull_points(parts[0].geometry)) < len(hull_points(shape.geometry)) + 8


def test_a_flat_mesh_is_refused(tmp_path):
    vertices, faces = vessel(**BIN)
    path = write_obj(tmp_path / "flat.obj", vertices * [1, 1, 0], faces)
    with pytest.raises(RobotError, match=r"flat\.obj is flat"):
        collision_shapes([Shape(Mesh(path))])


def arm_with(folder, shape):
    """An arm of three joints, one link with another shape."""
    (folder / "arm.urdf").write_text(URDF.replace(SHAPE, SHAPE + shape, 1))
    (folder / "arm.srdf").write_text(SRDF)
    return load_robot(RobotSpec(urdf="arm.urdf", srdf="arm.srdf"), folder)


def test_a_missing_visual_mesh_is_a_note(tmp_path):
    visual = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    for name in ("gone.stl", "package://gone/a.stl", "/etc/outside.stl"):
        [note] = [each for each in arm_with(tmp_path, visual.format(name)).notes if name in each]
        assert note.startswith("link 'upper': the visual is not drawn: ")
    several = "".join(visual.format(f"gone_{number}.stl") for number in range(13))
    [note] = [each for each in arm_with(tmp_path, several).notes if "gone" in each]
    assert note.startswith("13 visuals are not drawn, of upper; the first: 'gone_0.stl'")


def test_a_robots_folder_says_how_its_links_collide_unless_the_scenario_does(tmp_path):
    write_obj(tmp_path / "bin.obj", *vessel(**BIN))
    mesh = '<collision><geometry><mesh filename="bin.obj"/></geometry></collision>'
    (tmp_path / "arm.urdf").write_text(URDF.replace(SHAPE, mesh))
    (tmp_path / "arm.srdf").write_text(SRDF)
    (tmp_path / "robot.yaml").write_text(
        "robot: three\nkind: arm\nurdf: arm.urdf\nsrdf: arm.srdf\narm_group: manipulator\n"
        "tcp_link: tool\ncollision: {upper: hull, lower: exact}\n"
    )

    def modes(**words):
        arm = load_robot(RobotSpec.model_validate({"model": str(tmp_path), **words}))
        named = [each for each in arm.links if each.collisions]
        return {each.name: each.collisions[0].geometry.collision for each in named}

    assert modes() == {"upper": "hull", "lower": "exact", "wrist": "parts"}
    given = modes(collision={"lower": "hull"})
    assert given == {"upper": "hull", "lower": "hull", "wrist": "parts"}
    assert set(modes(collision="exact").values()) == {"exact"}


def test_a_check_of_a_robot_says_what_stands_for_its_meshes(tmp_path):
    write_obj(tmp_path / "bin.obj", *vessel(**BIN))
    mesh = '<collision><geometry><mesh filename="bin.obj"/></geometry></collision>'
    description = arm_with(tmp_path, mesh)
    [note] = [note for note in description.notes if "convex parts" in note]
    assert note.startswith("5 convex parts stand for the meshes of upper; they reach at most ")
    report = check_robot(description, "arm.urdf", samples=5).report
    [found] = [each for each in report.findings if each.about == "collision shapes"]
    assert found.details[0].startswith("upper: bin.obj collides as 5 convex parts, at most ")
